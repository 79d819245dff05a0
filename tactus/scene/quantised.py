"""Counts where the hardware of a quantised network differs from its file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from golden.engine.quantise import integer_networks
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork, Trained, forward_passes
from tactus.scene.scale import readings

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


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
        quantised = isinstance(network, DenseNetwork) and network.quantised
        if not quantised or member.inputs != len(scene.inputs):
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
            f"{member.weights_path.name}: {differ} of {every} codes of {len(codes)} recorded "
            f"frames differ from those of the file"
            + (f", by {furthest} at most: {where}" if differ else "")
            + f"; readings are rounded to {SIGNAL.width} bits before, which changes {moved} of them"
        )
    return lines


def file_codes(network: Trained, readings: Real) -> Iterator[Codes]:
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
