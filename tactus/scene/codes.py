"""What the codes of a scene stand for, and where the hardware is not what its networks compute.

An output saturates where a network exceeds the codes. A hidden sum behind ReLU or a linear layer
can saturate where the range of its layer is from the data; see ``golden.engine.ranges``. Codes of a
quantised network may differ from those of its file.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from golden.engine.quantise import integer_networks
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork, forward_passes
from golden.trained.function import LOW
from tactus.network_files.parsed import short_path
from tactus.scene.scale import readings

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def ranges(scene: Scene) -> list[str]:
    """A line for each sensor and output that has a scale or a unit.

    Neighbouring columns of the same scale and unit share a line.
    """
    ends = SIGNAL.to_real(np.array([[SIGNAL.low], [SIGNAL.high]]))
    found: list[tuple[str, list[str], str]] = []
    for kind, columns in (("sensor", scene.sensors), ("output", scene.outputs)):
        for name, scale in zip(columns, scene.scales(columns), strict=True):
            if name in scene.known_scales or name in scene.units:
                low, high = readings(ends, [scale]).ravel()
                unit = f" {scene.units[name]}" if name in scene.units else ""
                text = (
                    f"code {SIGNAL.low} is {low:.6g}{unit}, {SIGNAL.high} is {high:.6g}{unit}, "
                    f"one code {scale.factor / (1 << SIGNAL.frac):.6g}{unit}"
                )
                if found and found[-1][::2] == (kind, text):
                    found[-1][1].append(name)
                else:
                    found.append((kind, [name], text))
    return [
        f"{kind} {names[0]}: {text}"
        if len(names) == 1
        else f"{kind}s {names[0]} to {names[-1]}: {text}"
        for kind, names, text in found
    ]


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
        for layer, counts in scene.twin().core.saturations(vectors.codes).items()
        if counts.any()
    ]


def held(scene: Scene) -> list[str]:
    """A sentence for each layer whose sums leave a table whose function is not level there.

    Recorded frames tell. Beyond the ends of its table a function keeps its value.
    """
    sentences = []
    for member, network in zip(scene.members, scene.networks(), strict=True):
        if not any(f.goes_on for layer in network.layers for f in layer.functions):
            continue
        for number, found in enumerate(forward_passes(network, scene.inputs_of(network)), start=1):
            layer, sums = found.layer, found.sums
            goes_on = [function.goes_on for function in layer.functions]
            beyond = (np.abs(sums) > -LOW) & goes_on if goes_on else np.zeros_like(sums, dtype=bool)
            if beyond.any():
                nodes = np.unique(np.nonzero(beyond)[1]).tolist()
                names = dict.fromkeys(layer.functions[node].name for node in nodes)
                sentences.append(
                    f"{short_path(member.weights_path)}: layer {number}: sums reach "
                    f"{np.abs(sums[beyond]).max():.3g} in {beyond.any(axis=1).sum()} of "
                    f"{len(sums)} recorded frames; beyond {LOW:g} and {-LOW:g} "
                    f"{', '.join(names)} keeps its value"
                )
    return sentences


def range_lines(scene: Scene, counts: dict[str, Codes], rows: str = "recorded frames") -> list[str]:
    """For each hidden layer in which saturation would be an error its range, and what saturates.

    counts: What ``saturations`` of the twin gives for some frames.
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
    for sentence in saturating(scene):
        warnings.warn(f"{scene.path}: {sentence}", stacklevel=2)


def quantised_lines(scene: Scene) -> list[str]:
    """A line for each quantised network: how many codes differ on the recorded frames, and where.

    The file is evaluated node by node in double precision, on readings that are rounded to the
    codes of samples as the hardware rounds them; the line also says how many codes this rounding
    changes. A network that reads outputs of an earlier one is left out.
    """
    vectors = scene.vectors()
    codes = vectors.codes
    lines = []
    for member, network in zip(scene.members, scene.networks(), strict=True):
        if not network.quantised or member.inputs != len(scene.inputs):
            continue
        held, scales = member.load(), scene.scales(scene.inputs)
        of_file, unrounded = (
            list(file_codes(held, readings(signals, scales)))
            for signals in (SIGNAL.to_real(codes), vectors.inputs)
        )
        (whole,) = integer_networks("single", [network])
        counts = [
            np.abs(ours - theirs)
            for theirs, ours in zip(of_file, whole.hidden_codes(codes), strict=False)
        ]
        differ, every = sum((c > 0).sum() for c in counts), sum(c.size for c in counts)
        furthest = max(int(c.max(initial=0)) for c in counts)
        moved = sum((a != b).sum() for a, b in zip(of_file, unrounded, strict=True))
        where = ", ".join(
            f"{(c > 0).sum()} in layer {n}" for n, c in enumerate(counts, start=1) if c.any()
        )
        lines.append(
            f"{short_path(member.weights_path)}: {differ} of {every} codes of {len(codes)} "
            f"recorded frames differ from those of the file"
            + (f", by {furthest} at most: {where}" if differ else "")
            + f"; readings are rounded to {SIGNAL.width} bits before, which changes {moved} of them"
        )
    return lines


def file_codes(network: DenseNetwork, readings: Real) -> Iterator[Codes]:
    """The codes of each hidden layer, shape (frames, nodes), as differences from the lowest code.

    The network is evaluated node by node in double precision. The codes end at the first layer
    without a quantiser.

    network: As its file holds it.
    readings: shape (frames, inputs).
    """
    for found in forward_passes(network, readings):
        quantiser = found.layer.quantiser
        if quantiser is None:
            return
        rectifies = found.layer.activation == "relu"
        lowest = max(quantiser.low, quantiser.zero) if rectifies else quantiser.low
        codes = np.rint(found.outputs / quantiser.scale).astype(np.int64)
        yield codes + quantiser.zero - lowest
