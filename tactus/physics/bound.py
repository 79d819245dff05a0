"""The precision with which noisy gauges can determine a load: the bound of Cramer and Rao.

No unbiased estimator has a smaller standard deviation, whatever it is: a network of any size, or a
search through the model itself. An estimator that is *not* unbiased, such as one that knows which
loads there are, may be better; ``known_loads`` computes how much better.

Load, position and width are unknown, and the shape is known. The shape is one of two, so there is
no derivative by it. Moreover, shape and an unknown width cannot both be found from the readings:
both only affect the gauges under the load, and a triangle gives the readings of a narrower
rectangle.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.domain import checked
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, LOAD_G, POSITION_MM, WIDTH_MM
from tactus.physics.strain_sensor import StrainSensor, loads_from_codes

# The unknowns, in the order of the coded targets.
UNKNOWN = ("load", "position", "width")

# The mean magnitude of a normally distributed error, as a part of its standard deviation.
MEAN_PER_DEVIATION = math.sqrt(2 / math.pi)

# If less than this part of a column is independent of the others, it is only rounding.
_ROUNDING = 1e-9


def slopes_by_codes(sensors: Sequence[StrainSensor], codes: ArrayLike) -> Real:
    """Derivatives of the readings by coded load, position and width.

    sensors: Gauges on the same beam.
    codes, shape (n, 4): Placements as coded targets; see ``loads_from_codes``.

    Returns, shape (n, sensors, 3): In V for one unit of the code.
    """
    loads = loads_from_codes(codes, sensors[0].beam)
    # Codes count the position from the tip, but the beam counts it from the root.
    si = np.array([LOAD_G / 1e3, -POSITION_MM / 1e3, WIDTH_MM / 2e3]) / FULL_SCALE
    return np.stack([sensor.slopes(loads) for sensor in sensors], axis=-2) * si


def least_deviations(slopes: ArrayLike, noise: ArrayLike) -> Real:
    """The bound: the least standard deviation of each unknown if the others are unknown too.

    Equation: it is the square root of the diagonal of the inverse of the Fisher information ``J^T
    S^-1 J``. It is computed as 1 over the length of that part of a column of ``S^-1/2 J`` that is
    independent of the other columns. This exists even where the inverse does not.

    slopes, shape (..., readings, unknowns): J, the derivatives of the readings.
    noise: Standard deviation of the noise of each reading, or one number for all; above 0.

    Returns, shape (..., unknowns): Infinite where the effect of an unknown on the readings can be
        that of another one.
    """
    least, most = float(np.finfo(np.float64).tiny), float(np.finfo(np.float64).max)
    (sigma,) = checked(noise=(noise, least, most))
    matrix = np.asarray(slopes, dtype=np.float64)
    readings, unknowns = matrix.shape[-2:]
    if sigma.ndim > 1 or sigma.size not in (1, readings):
        raise InputError(f"noise: got shape {sigma.shape}, expected one number or {readings}")
    matrix = matrix / np.broadcast_to(sigma, readings)[:, np.newaxis]
    lengths = np.linalg.norm(matrix, axis=-2, keepdims=True)
    # All columns get the same length, so that smallness does not depend on units.
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
    """The bound of each placement in percent, as the errors of networks are stated.

    Equation: ``100 sqrt(2 / pi) sigma / scale``. With little noise the errors of an estimator that
    reaches the bound have a normal distribution, and their mean magnitude is ``sqrt(2 / pi)`` times
    their standard deviation.

    sensors, codes: See ``slopes_by_codes``.
    noise: See ``least_deviations``.
    scale, shape (n, 3): The number that is 100 %; see ``tactus.scene.metrics.error_scale``.

    Returns, shape (n, 3): The bounds of load, position and width.
    """
    deviations = least_deviations(slopes_by_codes(sensors, codes), noise)
    return 100 * MEAN_PER_DEVIATION * deviations / np.asarray(scale)
