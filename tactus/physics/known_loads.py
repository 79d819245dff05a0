"""The precision of an estimator that knows beforehand which loads there are.

The bound of Cramer and Rao (``bound``) is for estimators that are unbiased for every load. An
estimator with prior knowledge can be better, and can even determine what the readings do not
contain. Its least mean error is that of the median of the distribution after the readings.
"""

from collections.abc import Sequence

import numpy as np

from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, POSITION_MM
from tactus.physics.bound import least_deviations, slopes_by_codes
from tactus.physics.strain_sensor import StrainSensor, loads_from_codes, read_sensors

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
