"""A network from elsewhere, for which a scene is drafted."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.function import TABLE
from tactus.network_files.classes import for_labels
from tactus.network_files.network_file import held_in
from tactus.network_files.parsed import ParsedNetwork
from tactus.rig.survey import Survey, labels_in
from tactus.scene.labels import ordered

# The part of the recorded range that a drafted range leaves on either side.
SPARE = 0.1


@dataclass(frozen=True)
class Brought:
    """A network file, and what a scene must say about it."""

    path: Path
    held: ParsedNetwork

    @property
    def shape(self) -> tuple[int, ...]:
        """Inputs, the hidden nodes of each layer, and outputs."""
        arrays, names = self.held.arrays, self.held.names
        return (np.shape(arrays["w1"])[1], *(np.size(arrays[name]) for name in names[1::2]))

    @property
    def activations(self) -> tuple[str, ...]:
        """The activations that a scene can name; none where the file has functions of its own."""
        kinds = self.held.activations
        return () if any(kind.startswith(TABLE) for kind in kinds) else kinds

    def range_of(self, values: Real) -> tuple[float, float]:
        """The offset and the factor of a scale whose range holds some values.

        A quantised network is exact with powers of two.
        """
        low, high = float(values.min()), float(values.max())
        if any(self.held.quantisers):
            return 0.0, 2.0 ** math.ceil(math.log2(max(abs(low), abs(high)) * (1 + 2.0**-13)))
        half = (1 + SPARE) * (high - low) / 2
        digits = 1 - math.floor(math.log10(half))
        step = 10.0**-digits
        factor = math.ceil(half / step) * step
        return round((low + high) / 2, digits), round(factor, max(digits, 0))


def brought(path: Path, found: Survey) -> Brought:
    """The network at ``path``, for the columns of a recording."""
    held = held_in(path)
    missing = [name for name in held.names if name not in held.arrays]
    if missing or np.ndim(held.arrays["w1"]) != 2:
        raise InputError(f"{path}: got no network, expected arrays {', '.join(held.names)}")
    labels: tuple[str, ...] = ()
    if found.classes:
        place = f"{found.recording.path}: column {found.classes!r}"
        labels = ordered(labels_in(found.recording, found.classes), place)
        held = for_labels(path, held, labels)
    network = Brought(path, held)
    inputs, *_, outputs = network.shape
    if inputs != len(found.sensors):
        left = "".join(f"; {name} is left out: {why}" for name, why in found.left_out.items())
        raise InputError(
            f"{path}: got a network of {inputs} inputs, expected {len(found.sensors)}, one for "
            f"each sensor of {found.recording.path}, {', '.join(found.sensors)}{left}"
        )
    wanted = len(labels or found.outputs)
    if outputs != wanted:
        what = f"label of {found.classes}" if found.classes else "output"
        raise InputError(
            f"{path}: got a network of {outputs} outputs, expected {wanted}, one for each {what}"
        )
    return network
