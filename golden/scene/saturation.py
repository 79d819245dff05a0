"""Outputs that leave the range of the codes: what the hardware then gives is the range's end."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from golden.scene.scene import Scene

# How far beyond the codes, as a signal, an output saturates and is not only rounded.
CLEARLY = 0.01


def saturating(scene: Scene) -> list[str]:
    """A sentence for each output that leaves the range of the codes on recorded frames.

    The networks are looked at in floating point, which takes no time whatever the design. A cascade
    gives its later networks what earlier ones give before they saturate, so of a cascade the first
    output that is named is sure.

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
        # What is no number, of weights that overflow a float, is no output either.
        beyond = ~(np.abs(column) <= 1 + CLEARLY)
        if beyond.any():
            count = "all" if beyond.all() else f"{beyond.sum()} of"
            sentences.append(
                f"output {name!r} saturates in {count} {len(column)} recorded frames: its network "
                f"gives up to {np.abs(column).max():.3g} times the range of the codes"
            )
    return sentences


def warn_saturating(scene: Scene) -> None:
    """Warn of outputs that saturate, a line for each."""
    for sentence in saturating(scene):
        warnings.warn(f"{scene.path}: {sentence}", stacklevel=2)
