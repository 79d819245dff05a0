"""Errors as the thesis reports them: in percent, in millimetres, and of activations."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class OutputError:
    """Error of one output over a set of frames, in percent or, see ``millimetres``, as lengths.

    mean: Mean error over all frames.
    largest_mean: Largest of the mean errors at each position (equation 3.15), which is the thesis'
        "better than" figure.
    worst: Largest error of a single frame.
    """

    mean: float
    largest_mean: float
    worst: float


def error_scale(
    targets: ArrayLike, outputs: Sequence[str], full_scale: dict[str, float]
) -> NDArray[np.float64]:
    """The divisor of each error: the full scale of its output, or the target's magnitude.

    By equation 3.16 the error in percent is ``100 * |t - y|`` divided by it.

    targets: shape (frames, outputs).
    outputs: Names of the columns.
    full_scale: Scales of the outputs whose error is divided by a constant (position and width:
        0.9).
    """
    scale = np.abs(np.asarray(targets, dtype=np.float64))
    for c, name in enumerate(outputs):
        if name in full_scale:
            scale[:, c] = full_scale[name]
    return scale


def summarise(errors: NDArray[np.float64], groups: ArrayLike) -> list[OutputError]:
    """A summary for each column of ``errors``, with means over each value of ``groups``."""
    places = np.asarray(groups)
    means = np.array([errors[places == place].mean(axis=0) for place in np.unique(places)])
    return [
        OutputError(float(errors[:, c].mean()), float(means[:, c].max()), float(errors[:, c].max()))
        for c in range(errors.shape[1])
    ]


def millimetres(error: OutputError, length: float) -> OutputError:
    """Turn an error in percent of a full scale into a length.

    Equation: local error / full scale * length (thesis section 3.12.1: the errors of position and
    width are divided by a constant). ``golden/numbers/units.py`` holds the lengths of the
    flexible digit and says how they were checked.

    error: Error of an output that is divided by a full scale, not by the target.
    length: The full scale in millimetres: 127 for position, 50.8 for width.
    """
    part = length / 100
    return OutputError(error.mean * part, error.largest_mean * part, error.worst * part)


@dataclass(frozen=True)
class ActivationError:
    """Error of an approximation over [-3, 3], against the exact activation.

    mean_percent: Equation 4.32 as printed: 100 / 6 times the integral of the error's magnitude.
    mean_percent_thesis: Twice that, (100 / 3) times the integral. The factor is a fit and not a
        derivation: with it the schemes come close to the figures that the thesis prints (Gradient
        0.41, printed 0.40); with equation 4.32 as printed they come to half of these figures.
    largest: Largest magnitude of the error, in units of 2**-13.
    """

    mean_percent: float
    mean_percent_thesis: float
    largest: float


ACTIVATION_RANGE = 3.0


def activation_error(errors: ArrayLike, q: ArrayLike) -> ActivationError:
    """Equation 4.32 for the errors of an approximation on a grid, by the trapezoidal rule.

    errors, shape (points,): Approximation minus exact value, at each ``q``.
    q, shape (points,): Rising; values outside [-3, 3] are ignored. A grid of codes may end one step
        short of 3, so the integral is divided by the length of the grid and not by 6.
    """
    miss, at = np.asarray(errors, dtype=np.float64), np.asarray(q, dtype=np.float64)
    inside = np.abs(at) <= ACTIVATION_RANGE
    miss, at = np.abs(miss[inside]), at[inside]
    mean = 100 * float(np.trapezoid(miss, at) / (at[-1] - at[0]))
    return ActivationError(mean, 2 * mean, float(8192 * miss.max()))
