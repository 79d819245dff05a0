"""Finds outputs outside the range of the codes, where the hardware gives the end of the range."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from golden.scene.scene import Scene

# How far an output, as a signal, must be beyond the codes to count as saturated and not as rounded.
CLEARLY = 0.01


def saturating(scene: Scene) -> list[str]:
    """A sentence for each output that exceeds the range of the codes on recorded frames.

    The networks are evaluated in floating point, which is fast for every design. The later networks
    of a cascade get the outputs of earlier ones before these saturate, so in a cascade only the
    first output that is named is certain.

    Raises
    ------
    InputError
        See ``mlps`` and ``vectors`` of ``Scene``.
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
    return sentences


def warn_saturating(scene: Scene) -> None:
    """Warn of outputs that saturate, with one line for each."""
    for sentence in saturating(scene):
        warnings.warn(f"{scene.path}: {sentence}", stacklevel=2)
