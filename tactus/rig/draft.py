"""Writes a scene for a recording, with comments that explain what was chosen."""

import csv
import json
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.function import TABLE
from tactus.core.files import replace_file
from tactus.core.templates import environment
from tactus.errors import NOISE
from tactus.network_files.network_file import held_in
from tactus.network_files.parsed import ParsedNetwork, for_labels
from tactus.rig import readings
from tactus.rig.survey import Survey, labels_in
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import MOST
from tactus.scene.keys import EDITOR_SCHEMA
from tactus.scene.labels import ordered
from tactus.scene.scale import AUTO
from tactus.train.split import scaled

# A name followed by its unit: load [g] or load (g).
UNIT = re.compile(r".*\S\s*(?:\[([^\[\]]+)\]|\(([^()]+)\))")
# The fewest rows of a session, in the mean.
ROWS_OF_SESSION = 8
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
        layers = self.held.layers
        return (layers[0].weights.shape[1], *(layer.biases.size for layer in layers))

    @property
    def activations(self) -> tuple[str, ...]:
        """The activations that a scene can name; none where the file has functions of its own."""
        kinds = self.held.activations
        return () if any(kind.startswith(TABLE) for kind in kinds) else kinds

    @property
    def exact(self) -> bool:
        """Whether it is quantised, so that powers of two keep it exact."""
        return any(layer.quantiser for layer in self.held.layers)

    def range_of(self, values: Real) -> tuple[float, float]:
        """The offset and the factor of a scale whose range holds some values."""
        low, high = float(values.min()), float(values.max())
        if self.exact:
            return 0.0, 2.0 ** math.ceil(math.log2(max(abs(low), abs(high)) * (1 + 2.0**-13)))
        half = (1 + SPARE) * (high - low) / 2
        digits = 1 - math.floor(math.log10(half))
        step = 10.0**-digits
        factor = math.ceil(half / step) * step
        return round((low + high) / 2, digits), round(factor, max(digits, 0))


def brought(path: Path, found: Survey) -> Brought:
    """The network at ``path``, for the columns of a recording."""
    held = held_in(path)
    weights = held.layers[0].weights
    if weights.ndim != 2:
        raise InputError(f"{path}: w1: got shape {weights.shape}, expected a row for each node")
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


def draft(
    found: Survey, path: Path, hardware: Scene | None = None, network: Brought | None = None
) -> str:
    """The text of the scene at ``path``.

    hardware: Scene whose hardware reads the sensors.
    network: The network that the scene is for. It is not trained.
    """
    templates = environment("tactus.rig")
    templates.filters |= {
        "bare": lambda text: _quoted(text)[1:-1],
        "key": _key,
        "listed": lambda names: f"[{', '.join(map(_quoted, names))}]",
        "quoted": _quoted,
        "table": lambda texts: f"{{ {', '.join(f'{_key(k)} = {v}' for k, v in texts.items())} }}",
    }
    outputs, session = list(found.outputs), _session(found)
    named = {name: UNIT.fullmatch(name) for name in [*found.sensors, *outputs]}
    columns = found.outputs if hardware else found.sensors | found.outputs
    wide = {n: v for n, v in columns.items() if readings.beyond(n, v)}
    scales = {}
    if hardware:
        known = {n: hardware.known_scales[n] for n in found.sensors if n in hardware.known_scales}
        scales = {name: _scale(one.offset, one.factor) for name, one in known.items()}
        scales |= dict.fromkeys(wide, _quoted(AUTO))
    elif network:
        scales = {name: _scale(*network.range_of(values)) for name, values in wide.items()}
    return templates.get_template("scene.toml.jinja").render(
        found=found,
        hardware=hardware,
        network=network,
        schema=os.path.relpath(EDITOR_SCHEMA, path.parent),
        name=found.recording.path.name,
        file=os.path.relpath(found.recording.path, path.parent),
        group=session or _positions(found),
        session=session,
        spans={name: f"{np.ptp(values):.6g}" for name, values in found.outputs.items()},
        wide=wide,
        scales=scales,
        units={name: _quoted(unit[1] or unit[2]) for name, unit in named.items() if unit},
        weights=os.path.relpath(network.path, path.parent) if network else f"{path.stem}.npz",
        noise=_noise(found, hardware),
    )


def _scale(offset: float, factor: float) -> str:
    return f"{{ offset = {offset!r}, factor = {factor!r} }}"


def _session(found: Survey) -> str:
    """The column of texts that repeat most, such as sessions or persons; empty if there is none."""
    counts = {}
    for name in found.recording.names:
        if name and name != found.classes and not found.recording.column(name).numeric:
            texts = labels_in(found.recording, name)
            if all(texts) and 1 < len(set(texts)) <= len(texts) / ROWS_OF_SESSION:
                counts[name] = len(set(texts))
    return min(counts, key=lambda name: counts[name]) if counts else ""


def _noise(found: Survey, hardware: Scene | None) -> str:
    """A first value for the noise, in the unit of the sensors.

    It is ``NOISE`` times half the range of the sensors, but at least the step of their readings,
    because the last bit of a converter is already a large part of its noise.
    """
    columns = list(found.sensors.values())
    if hardware:
        halves = [scale.factor for scale in hardware.scales(list(found.sensors))]
    elif found.beyond:
        halves = [float(values.max() / 2 - values.min() / 2) for values in columns]
    else:
        halves = [1.0]
    noise = max(NOISE * float(np.median(halves)), *map(readings.step, columns))
    return f"{float(f'{min(noise, MOST):.0e}'):g}"


def _positions(found: Survey) -> str:
    """Of the outputs that were set, so that every value repeats, the one with the most values."""
    counts = {n: np.unique(v, return_counts=True)[1] for n, v in found.outputs.items()}
    often = {name: len(rows) for name, rows in counts.items() if rows.min() > 1}
    return max(often, key=lambda name: often[name]) if often else ""


def _quoted(text: str) -> str:
    """A TOML string; JSON escapes in the same way except for one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def names_of(text: str) -> list[str]:
    """Column names separated by commas; a name that contains a comma is in double quotes."""
    try:
        return [name.strip() for name in next(csv.reader([text], skipinitialspace=True), [])]
    except csv.Error as error:
        raise InputError(f"OUTPUTS={text!r}: got no names between commas: {error}") from None


def check_sensors(found: Survey, hardware: Scene) -> None:
    """Refuse a recording with other sensors than those that a scene's hardware reads."""
    got = tuple(found.sensors)
    if got != hardware.sensors:
        why = "".join(
            f"; {name} is left out: {found.left_out[name]}"
            for name in hardware.sensors
            if name in found.left_out
        )
        raise InputError(
            f"{found.recording.path}: got the sensors {', '.join(got)}, expected "
            f"{', '.join(hardware.sensors)}, as {hardware.path} reads them{why}"
        )


def write_scene(
    found: Survey, path: Path, hardware: Scene | None = None, network: Brought | None = None
) -> Scene:
    """Write the scene, after a check that it can be read.

    hardware: Scene whose hardware has read the sensors, and will run the networks.
    network: The network that the scene is for.
    """
    with replace_file(path) as temporary:
        temporary.write_text(draft(found, path, hardware, network), encoding="utf-8")
        try:
            scene = load_scene(str(temporary))
            scaled(scene).vectors()
            if network:
                scene.networks()
        except InputError as error:
            raise InputError(str(error).replace(str(temporary), str(path))) from None
        trained = [] if network else [*scene.network_files, *scene.provenance_paths]
        for file in [path, *trained]:
            if file.exists() or file.is_symlink():
                raise InputError(f"{file}: is there already; choose another name with TO=")
    return load_scene(str(path))
