"""The precision with which noisy gauges can determine a load: the bound of Cramer and Rao.

No unbiased estimator has a smaller standard deviation, whatever it is: a network of any size, or a
search through the model itself. An estimator that is *not* unbiased, such as one that knows which
loads there are, may be better, and can even determine what the readings do not contain.
``least_errors`` computes its mean error: that of the median of the distribution after the readings.

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
from tactus.physics.strain_sensor import StrainSensor, loads_from_codes, read_sensors

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


# Load and position after the readings are searched within this many times their bound on both
# sides. The steps are half a bound wide, which changes an error by one per cent.
REACH, STEPS = 6, 25

# Values whose cumulative weights differ from one half by less count as equally good medians.
_TIE = 1e-6


def kinds_of(targets: Real, known_loads: bool) -> Real:
    """Load, width and shape of everything that can lie on the beam, shape (kinds, 3).

    targets, shape (n, 4): Coded placements.
    known_loads: Whether only the loads in ``targets`` are possible. Otherwise any load is possible,
        which NaN stands for, with any width and any shape that occur in ``targets``.
    """
    if known_loads:
        return np.unique(targets[:, [0, 2, 3]], axis=0)
    widths, shapes = (np.unique(targets[:, c]) for c in (2, 3))
    return np.array([[np.nan, width, shape] for width in widths for shape in shapes])


def least_errors(
    sensors: Sequence[StrainSensor],
    targets: Real,
    noise: Real,
    scale: Real,
    known_loads: bool,
    draws: int,
    rng: np.random.Generator,
) -> Real:
    """The mean error of the best such estimator at each placement, in percent.

    sensors: The sensors that are read; the estimator knows them.
    targets, shape (n, 4): Coded placements. They determine the kinds of loads, which are equally
        likely; see ``kinds_of``.
    noise, shape (sensors,): Standard deviation in V.
    scale, shape (n, 4): The number that is 100 %.
    draws: Number of readings at each placement.

    Returns: shape (n, 4).
    """
    beam = sensors[0].beam
    farthest = beam.length * 1e3 / POSITION_MM * FULL_SCALE
    kinds = kinds_of(targets, known_loads)
    relative = scale == np.abs(targets)
    spreads = least_deviations(slopes_by_codes(sensors, targets), noise)
    exact = read_sensors(sensors, loads_from_codes(targets, beam))
    errors = np.empty((len(targets), targets.shape[1]))
    for n, target in enumerate(targets):
        likely = _around(target, spreads[n], kinds, farthest)
        away = (read_sensors(sensors, loads_from_codes(likely, beam)) - exact[n]) / noise
        drawn = rng.standard_normal((draws, len(sensors)))
        # The squared distance, without the part that is the same for all candidates. The readings
        # themselves, in units of a small noise, are too large for it: their squares would hide it.
        fits = drawn @ away.T - (away**2).sum(axis=1) / 2
        after = np.exp(fits - fits.max(axis=1, keepdims=True))
        for c, values in enumerate(likely.T):
            weights = after / values if relative[n, c] else after
            miss = np.abs(_medians(values, weights) - target[c])
            errors[n, c] = 100 * miss.mean() / scale[n, c]
    return errors


def _around(target: Real, spread: Real, kinds: Real, farthest: float) -> Real:
    """Candidates of all kinds near a placement, none of them beyond the root of the beam."""
    steps = np.linspace(-REACH, REACH, STEPS)
    loads = target[0] + spread[0] * steps
    places = np.clip(target[1] + spread[1] * steps, 0, farthest)
    found = []
    for load, width, shape in kinds:
        own = loads[loads > 0] if np.isnan(load) else np.array([load])
        grid = np.stack(np.meshgrid(own, places, width, shape, indexing="ij"), axis=-1)
        found.append(grid.reshape(-1, 4))
    return np.concatenate(found)


def _medians(values: Real, weights: Real) -> Real:
    """The weighted median of ``values`` for each row of ``weights``.

    Where two values are equally good, it is their mean, and not the one that rounding favours.
    """
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[:, order], axis=1)
    half = total[:, -1:] / 2
    low, high = ((total >= half * (1 + side)).argmax(axis=1) for side in (-_TIE, _TIE))
    return (values[order][low] + values[order][high]) / 2
