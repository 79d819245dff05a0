"""How well a load can be known by an estimator that knows which loads there are.

The bound of Cramer and Rao (``bound``) is for estimators that are right on average whatever the
load. One that knows what is likely beforehand can be nearer, and can name what no reading holds:
its least mean error is that of the median of what is likely after the readings.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from golden.physics.bound import least_deviations, slopes_by_codes
from golden.physics.strain_sensor import StrainSensor, loads_from_codes, read_sensors
from golden.real import Real
from golden.units import FULL_SCALE, POSITION_MM

# Where load and position can be after the readings: this many times their bound to either side, in
# steps of a half of it, which cost an error one per cent.
REACH, STEPS = 6, 25

# Halves of all that is likely that differ by less are equal.
_TIE = 1e-6


def kinds_of(targets: Real, known_loads: bool) -> Real:
    """Load, width and shape of everything that may lie on the beam, shape (kinds, 3).

    Parameters
    ----------
    targets : float array, shape (n, 4)
        Coded placements.
    known_loads : bool
        Only those that stand in ``targets``. Otherwise any load, so NaN, of any width with any
        shape that stands there.
    """
    if known_loads:
        found: Real = np.unique(targets[:, [0, 2, 3]], axis=0)
        return found
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
    """Mean magnitude of the error at each placement, in percent, of the best such estimator.

    Parameters
    ----------
    sensors : sequence of StrainSensor
        What reads, and what the estimator knows.
    targets : float array, shape (n, 4)
        Coded placements; equally likely kinds of loads come from them, see ``kinds_of``.
    noise : float array, shape (sensors,)
        Standard deviation, V.
    scale : float array, shape (n, 4)
        What 100 % is.
    known_loads : bool
    draws : int
        Readings at each placement.
    rng : numpy Generator

    Returns
    -------
    float array, shape (n, 4)
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
        means = read_sensors(sensors, loads_from_codes(likely, beam)) / noise
        seen = exact[n] / noise + rng.standard_normal((draws, len(sensors)))
        # The square, without what is the same for all candidates.
        fits = seen @ means.T - (means**2).sum(axis=1) / 2
        after = np.exp(fits - fits.max(axis=1, keepdims=True))
        for c, values in enumerate(likely.T):
            weights = after / values if relative[n, c] else after
            miss = np.abs(_medians(values, weights) - target[c])
            errors[n, c] = 100 * miss.mean() / scale[n, c]
    return errors


def _around(target: Real, spread: Real, kinds: Real, farthest: float) -> Real:
    """Candidates near a placement, of all kinds, none beyond the root of the beam."""
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

    Where nothing decides between two values, half-way: not the one that rounding favours.
    """
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[:, order], axis=1)
    half = total[:, -1:] / 2
    low, high = ((total >= half * (1 + side)).argmax(axis=1) for side in (-_TIE, _TIE))
    result: Real = (values[order][low] + values[order][high]) / 2
    return result
