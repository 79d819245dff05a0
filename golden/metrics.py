"""Errors in percent, as the thesis reports them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class OutputError:
    """Error of one output over a set of frames, in percent.

    Attributes
    ----------
    mean : float
        Over all frames.
    largest_mean : float
        The largest, over the positions, of the mean error at that position (equation 3.15): the
        thesis' "better than" figure.
    worst : float
        Of any single frame.
    """

    mean: float
    largest_mean: float
    worst: float


def error_scale(
    targets: ArrayLike, outputs: Sequence[str], full_scale: dict[str, float]
) -> NDArray[np.float64]:
    """What each error counts against: the full scale of its output, or the target's magnitude.

    Parameters
    ----------
    targets : float array, shape (frames, outputs)
    outputs : sequence of str
        Names of the columns.
    full_scale : dict
        Scales of the outputs with a local error (position and width: 0.9).
    """
    scale = np.abs(np.asarray(targets, dtype=np.float64))
    for c, name in enumerate(outputs):
        if name in full_scale:
            scale[:, c] = full_scale[name]
    return scale


def percent_errors(
    results: ArrayLike,
    targets: ArrayLike,
    outputs: Sequence[str],
    full_scale: dict[str, float],
) -> NDArray[np.float64]:
    """Equation 3.16: |t - y| in percent of the target, or of a full scale where one is given.

    Parameters
    ----------
    results, targets : float arrays, shape (frames, outputs)
    outputs, full_scale
        See ``error_scale``.
    """
    miss = np.abs(np.asarray(targets, dtype=np.float64) - np.asarray(results))
    return np.asarray(100 * miss / error_scale(targets, outputs, full_scale))


def summarise(errors: NDArray[np.float64], groups: ArrayLike) -> list[OutputError]:
    """One summary per column of ``errors``, with means over each value of ``groups``."""
    places = np.asarray(groups)
    means = np.array([errors[places == place].mean(axis=0) for place in np.unique(places)])
    return [
        OutputError(float(errors[:, c].mean()), float(means[:, c].max()), float(errors[:, c].max()))
        for c in range(errors.shape[1])
    ]
