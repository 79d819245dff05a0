"""Finds outputs and hidden sums beyond their range, where the hardware gives the end of the range.

An output saturates where a network exceeds the codes. A hidden sum behind ReLU or a linear layer
can saturate where the range of its layer is from the data; see ``golden.engine.ranges``.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from golden.numbers.fixed import Codes
from golden.trained.dense import forward_passes, layers_of
from golden.trained.function import LOW

if TYPE_CHECKING:
    from tactus.scene.scene import Scene

# How far an output, as a signal, must be beyond the codes to count as saturated and not as rounded.
CLEARLY = 0.01


def saturating(scene: Scene) -> list[str]:
    """A sentence for each output and each hidden layer that saturates on recorded frames.

    For the outputs the networks are evaluated in floating point, which is fast for every design.
    The later networks of a cascade get the outputs of earlier ones before these saturate, so in a
    cascade only the first output that is named is certain.
    """
    vectors = scene.vectors()
    with np.errstate(over="ignore", invalid="ignore"):
        results = scene.process_real(vectors.inputs)
    sentences = []
    for name, column in zip(scene.outputs, results.T, strict=True):
        # An output that is no number, because weights overflow a float, counts as saturated too.
        beyond = ~(np.abs(column) <= 1 + CLEARLY)
        if beyond.any():
            count = "all" if beyond.all() else f"{beyond.sum()} of"
            sentences.append(
                f"output {name!r} saturates in {count} {len(column)} recorded frames: its network "
                f"gives up to {np.abs(column).max():.3g} times the range of the codes"
            )
    return [*sentences, *held(scene)] + [
        _counted(layer, counts, "recorded frames")
        for layer, counts in hidden_saturations(scene, vectors.codes).items()
        if counts.any()
    ]


def held(scene: Scene) -> list[str]:
    """A sentence for each layer whose sums leave a table whose function is not level there.

    Recorded frames tell. Beyond the ends of its table a function keeps its value.
    """
    sentences = []
    for member, network in zip(scene.members, scene.networks(), strict=True):
        if not any(f.goes_on for layer in layers_of(network) for f in layer.functions):
            continue
        for number, found in enumerate(forward_passes(network, scene.inputs_of(network)), start=1):
            layer, sums = found.layer, found.sums
            goes_on = [function.goes_on for function in layer.functions]
            beyond = (np.abs(sums) > -LOW) & goes_on if goes_on else np.zeros_like(sums, dtype=bool)
            if beyond.any():
                nodes = np.unique(np.nonzero(beyond)[1]).tolist()
                names = dict.fromkeys(layer.functions[node].name for node in nodes)
                sentences.append(
                    f"{member.weights_path.name}: layer {number}: sums reach "
                    f"{np.abs(sums[beyond]).max():.3g} in {beyond.any(axis=1).sum()} of "
                    f"{len(sums)} recorded frames; beyond {LOW:g} and {-LOW:g} "
                    f"{', '.join(names)} keeps its value"
                )
    return sentences


def hidden_saturations(scene: Scene, codes: Codes) -> dict[str, Codes]:
    """For each hidden layer whose range is from the data, how many sums saturate in each frame.

    codes, shape (frames, inputs): Codes of the networks' inputs.
    """
    return scene.twin().core.saturations(codes)


def range_lines(scene: Scene, counts: dict[str, Codes], rows: str = "recorded frames") -> list[str]:
    """For each hidden layer in which saturation would be an error its range, and what saturates.

    counts: See ``hidden_saturations``.
    rows: What the frames are, in words.
    """
    return [
        f"{one.text}; {_counted('', counts[one.layer], rows)}" if one.from_data else one.text
        for one in scene.twin().core.ranges
    ]


def _counted(layer: str, counts: Codes, rows: str) -> str:
    if not counts.any():
        return f"no sum saturates in {len(counts)} {rows}"
    place = f"{layer}: " if layer else ""
    return f"{place}{counts.sum()} sums saturate, in {(counts > 0).sum()} of {len(counts)} {rows}"


def warn_saturating(scene: Scene) -> None:
    """Warn of outputs that saturate, with one line for each."""
    for sentence in saturating(scene):
        warnings.warn(f"{scene.path}: {sentence}", stacklevel=2)
