"""How well a load can be known from noisy gauges: the bound of Cramer and Rao.

No estimator that is right on average has a smaller standard deviation, whatever it is: a network
of any size, or a search through the model itself. An estimator that is *not* right on average, as
one that knows which loads there are, may be nearer; ``known_loads`` says how near.

Load, position and width are unknown, the shape is known. It is one of two, so nothing can be
derived by it; and together with an unknown width it is never in the readings: both show in the
gauges under the load alone, and a triangle reads as a narrower rectangle does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from golden.domain import checked
from golden.input_error import InputError
from golden.physics.strain_sensor import StrainSensor, loads_from_codes
from golden.real import Real
from golden.units import FULL_SCALE, LOAD_G, POSITION_MM, WIDTH_MM

# What is unknown, in the order of the coded targets.
UNKNOWN = ("load", "position", "width")

# The mean magnitude of an error that is normal, as a part of its standard deviation.
MEAN_PER_DEVIATION = math.sqrt(2 / math.pi)

# A part of a column that lies outside the others and is smaller than this is rounding.
_ROUNDING = 1e-9


def slopes_by_codes(sensors: Sequence[StrainSensor], codes: ArrayLike) -> Real:
    """Derivatives of the readings by coded load, position and width.

    Parameters
    ----------
    sensors : sequence of StrainSensor
        On one beam.
    codes : array_like of float, shape (n, 4)
        Placements as coded targets; see ``loads_from_codes``.

    Returns
    -------
    float array, shape (n, sensors, 3)
        V for one unit of the code.
    """
    loads = loads_from_codes(codes, sensors[0].beam)
    # Codes count the position from the tip, the beam from its root.
    si = np.array([LOAD_G / 1e3, -POSITION_MM / 1e3, WIDTH_MM / 2e3]) / FULL_SCALE
    return np.stack([sensor.slopes(loads) for sensor in sensors], axis=-2) * si


def least_deviations(slopes: ArrayLike, noise: ArrayLike) -> Real:
    """The bound: least standard deviation of each unknown, where the others are unknown too.

    Equation: the square root of the diagonal of the inverse of the Fisher information
    ``J^T S^-1 J``. It is taken as 1 over the length of that part of a column of ``S^-1/2 J`` that
    the other columns cannot make, which exists where the inverse does not.

    Parameters
    ----------
    slopes : array_like of float, shape (..., readings, unknowns)
        J, derivatives of the readings.
    noise : array_like of float
        Standard deviation of the noise of each reading, or one for all; above 0.

    Returns
    -------
    float array, shape (..., unknowns)
        Infinite where the readings hold nothing of an unknown that could not be another.

    Raises
    ------
    InputError
        For noise of 0 or less, or another number of readings.
    """
    least, most = float(np.finfo(np.float64).tiny), float(np.finfo(np.float64).max)
    (sigma,) = checked(noise=(noise, least, most))
    matrix = np.asarray(slopes, dtype=np.float64)
    readings, unknowns = matrix.shape[-2:]
    if sigma.ndim > 1 or sigma.size not in (1, readings):
        raise InputError(f"noise: got shape {sigma.shape}, expected one number or {readings}")
    matrix = matrix / np.broadcast_to(sigma, readings)[:, np.newaxis]
    lengths = np.linalg.norm(matrix, axis=-2, keepdims=True)
    # Columns of one length, so that what is small is small whatever the units.
    unit = np.divide(matrix, lengths, out=np.zeros_like(matrix), where=lengths > 0)
    found = []
    for k in range(unknowns):
        column, others = unit[..., k : k + 1], np.delete(unit, k, axis=-1)
        made = others @ np.linalg.pinv(others, rcond=_ROUNDING) @ column
        own = np.linalg.norm(column - made, axis=(-2, -1))
        part = np.where(own > _ROUNDING, own, 0) * lengths[..., 0, k]
        found.append(np.divide(1, part, out=np.full(part.shape, np.inf), where=part > 0))
    return np.stack(found, axis=-1)


def least_mean_errors(
    sensors: Sequence[StrainSensor], codes: ArrayLike, noise: ArrayLike, scale: ArrayLike
) -> Real:
    """The bound of each placement as the networks' errors are given: in percent.

    Equation: ``100 sqrt(2 / pi) sigma / scale``: the errors of an estimator that reaches the bound
    are normal in the limit of little noise, and the mean magnitude of a normal error is
    ``sqrt(2 / pi)`` of its standard deviation.

    Parameters
    ----------
    sensors, codes
        See ``slopes_by_codes``.
    noise : array_like of float
        See ``least_deviations``.
    scale : array_like of float, shape (n, 3)
        What 100 % is; see ``golden.metrics.error_scale``.

    Returns
    -------
    float array, shape (n, 3)
        Load, position and width.
    """
    deviations = least_deviations(slopes_by_codes(sensors, codes), noise)
    result: Real = 100 * MEAN_PER_DEVIATION * deviations / np.asarray(scale)
    return result
