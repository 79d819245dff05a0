"""Gain and offset of each sensor, from a few placements whose outputs are known.

The networks stay what they are. What is fitted is a correction ``gain * reading + offset`` of each
sensor before them. It is general: the placements need not stand in the recording, and any scene can
be recalibrated.

It is a Bayesian linear regression through the derivatives of the networks:

- ``theta`` is what the sensors have drifted by, in standard deviations of the drift that is
  expected. Beforehand its mean is 0 and its covariance ``I``.
- A placement says ``known outputs = outputs of the corrected readings + e``. ``S`` is the
  covariance of ``e``: what networks err of themselves, and noise of the readings. See
  ``Sensitivity``.
- What is likeliest afterwards is where ``sum e^T S^-1 e + theta^T theta`` is least: a ridge
  regression whose weight is the drift that is expected. With ``J``, the derivatives of the outputs
  by ``theta``, its covariance is ``C = (I + sum J^T S^-1 J)^-1``.

Where placements tell little against their noise, ``theta`` stays near 0, which is no correction.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares
from scipy.special import chdtrc

from golden.real import Real
from golden.recalibration.placements import Placements
from golden.recalibration.sensitivity import Sensitivity, outputs_and_slopes

# Of a signal: to the bit.
LEAST_SPAN = 2.0**-13


@dataclass(frozen=True)
class Fit:
    """What is known of the drift after some placements.

    Attributes
    ----------
    theta : float array, shape (2 sensors,)
        The likeliest; see ``Sensitivity``.
    covariance : float array, shape (2 sensors, 2 sensors)
        How unsure it is.
    """

    theta: Real
    covariance: Real


def fit(recorded: Sensitivity, placements: Placements, start: Real | None = None) -> Fit:
    """What the sensors have drifted by.

    Parameters
    ----------
    recorded : Sensitivity
    placements : Placements
    start : float array, shape (2 sensors,), optional
        Where the descent starts. By default there are two, and the better is taken: from no
        correction, and from the one that brings the readings next to those that were recorded at
        the nearest placement. The first alone may end elsewhere.
    """
    scene, samples = recorded.scene, placements.inputs
    roots = np.linalg.cholesky(recorded.spread(placements))
    white = np.linalg.inv(roots) * (100 / placements.scale)[:, np.newaxis]
    count = 2 * samples.shape[1]

    @lru_cache(maxsize=1)
    def both(theta: bytes) -> tuple[Real, Real]:
        """Outputs and slopes: a descent asks for either at the same place."""
        return outputs_and_slopes(scene, recorded.moved(samples, np.frombuffer(theta)))

    def errors(theta: Real) -> Real:
        outputs, _ = both(theta.tobytes())
        misses = np.einsum("rop,rp->ro", white, outputs - placements.targets)
        return np.concatenate([misses.ravel(), theta])

    def derivatives(theta: Real) -> Real:
        _, slopes = both(theta.tobytes())
        found = (white @ recorded.by_theta(slopes, samples)).reshape(-1, count)
        return np.concatenate([found, np.eye(count)])

    starts = [start]
    if start is None:
        starts = [np.zeros(count), _towards_recorded(recorded, placements)]
    found = [least_squares(errors, start, jac=derivatives) for start in starts]
    theta = min(found, key=lambda one: float(one.cost)).x
    slopes = derivatives(theta)
    return Fit(theta, np.asarray(np.linalg.inv(slopes.T @ slopes), dtype=np.float64))


def misses(recorded: Sensitivity, placements: Placements, theta: Real) -> Real:
    """Outputs less known outputs of corrected placements, shape (placements, outputs), percent."""
    outputs, _ = outputs_and_slopes(recorded.scene, recorded.moved(placements.inputs, theta))
    return 100 * (outputs - placements.targets) / placements.scale


def by_chance(recorded: Sensitivity, placements: Placements) -> float:
    """How likely errors as large as those of the placements are if nothing has drifted.

    Equation: ``sum e^T S^-1 e`` of uncorrected placements is then distributed as chi squared, with
    as many degrees of freedom as there are known outputs.
    """
    found = misses(recorded, placements, np.zeros(2 * placements.inputs.shape[1]))
    inverse = np.linalg.inv(recorded.spread(placements))
    squares = np.einsum("ro,rop,rp->", found, inverse, found)
    return float(chdtrc(found.size, squares))


@dataclass(frozen=True)
class LeftOut:
    """Errors of placements that took no part in the correction, in percent.

    Attributes
    ----------
    before, after : float array, shape (placements, outputs)
        Without a correction, and with the one that is fitted to all other placements.
    expected : float array, shape (placements, outputs)
        Standard deviations that the second should have.
    spread : float array, shape (placements, outputs)
        Of these what is no drift.
    """

    before: Real
    after: Real
    expected: Real
    spread: Real

    @property
    def closer(self) -> bool:
        """Whether they come out closer with corrections than without, each error weighed by what is
        no drift in it."""
        before, after = (((part / self.spread) ** 2).sum() for part in (self.before, self.after))
        return bool(after < before)


def left_out(recorded: Sensitivity, placements: Placements, all_of_them: Fit) -> LeftOut:
    """Leave out one placement after the other, with all its readings.

    Parameters
    ----------
    recorded : Sensitivity
    placements : Placements
    all_of_them : Fit
        To all placements: where the descents without one start.
    """
    before = misses(recorded, placements, np.zeros(2 * placements.inputs.shape[1]))
    spread = np.einsum("roo->ro", recorded.spread(placements))
    after, expected = np.empty_like(before), np.empty_like(before)
    tells = recorded.telling(placements)
    for number in range(len(placements)):
        found = fit(recorded, placements.without(number), all_of_them.theta)
        after[number] = misses(recorded, placements, found.theta)[number]
        unsure = np.einsum("oi,ij,oj->o", tells[number], found.covariance, tells[number])
        expected[number] = np.sqrt(spread[number] + unsure)
    return LeftOut(before, after, expected, np.sqrt(spread))


def _towards_recorded(recorded: Sensitivity, placements: Placements) -> Real:
    """The correction that brings readings next to those recorded at the nearest placement."""
    first = recorded.nearest(placements)[:, 0]
    missing = recorded.recorded.inputs[first] - placements.inputs
    moves = recorded.moves(placements.inputs)
    sensors = missing.shape[1]
    found = []
    for sensor in range(sensors):
        # A little of the least correction, where readings that hardly differ say nothing of both.
        matrix = np.vstack([moves[:, [sensor, sensor + sensors]], LEAST_SPAN * np.eye(2)])
        found.append(np.linalg.lstsq(matrix, np.append(missing[:, sensor], [0, 0]))[0])
    return np.concatenate(np.array(found).T)
