"""Fits gain and offset of each sensor to a few placements whose outputs are known.

It is a Bayesian linear regression through the derivatives of the networks: docs/recalibration.md
names its ``theta``, ``e``, ``S``, ``J`` and ``C``. Placements need not be in the recording.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.special import chdtrc

from golden.numbers.real import Real
from tactus.recalibration.sensitivity import Placements, Sensitivity, outputs_and_slopes

# The least span of signals, which is one code.
LEAST_SPAN = 2.0**-13


class Fit(NamedTuple):
    """The knowledge of the drift after some placements.

    theta, shape (2 sensors,): The most likely drift; see ``Sensitivity``.
    root, shape (2 sensors, 2 sensors): The uncertainty of the drift as a lower triangle L of the
        covariance L L^T, which is never negative, as a rounded covariance could be.
    """

    theta: Real
    root: Real


def fit(recorded: Sensitivity, placements: Placements, start: Real | None = None) -> Fit:
    """Estimate how far the sensors have drifted.

    start, shape (2 sensors,): Where the descent starts. By default the better of two is used: from
        no correction, which alone could end in another minimum, and from the one that brings the
        readings next to those recorded at the nearest placement.
    """
    scene, samples = recorded.scene, placements.inputs
    roots = np.linalg.cholesky(recorded.spread(placements))
    white = np.linalg.inv(roots) * (100 / placements.scale)[:, np.newaxis]
    count = 2 * samples.shape[1]

    def errors(theta: Real) -> Real:
        outputs, _ = outputs_and_slopes(scene, recorded.moved(samples, theta))
        misses = np.einsum("rop,rp->ro", white, outputs - placements.targets)
        return np.concatenate([misses.ravel(), theta])

    def derivatives(theta: Real) -> Real:
        _, slopes = outputs_and_slopes(scene, recorded.moved(samples, theta))
        found = (white @ recorded.by_theta(slopes, samples)).reshape(-1, count)
        return np.concatenate([found, np.eye(count)])

    starts = [start]
    if start is None:
        starts = [np.zeros(count), _towards_recorded(recorded, placements)]
    found = [least_squares(errors, start, jac=derivatives) for start in starts]
    theta = min(found, key=lambda one: float(one.cost)).x
    return Fit(theta, root_of_inverse(derivatives(theta)))


def root_of_inverse(slopes: Real) -> Real:
    """The lower triangle L with L L^T = (J^T J)^-1, without the product, which doubles the digits.

    slopes, shape (equations, unknowns): J, of full rank.
    """
    inverse = np.linalg.inv(np.linalg.qr(slopes, mode="r"))
    lower = np.linalg.qr(inverse.T, mode="r").T  # type: ignore[attr-defined]
    return lower * np.sign(np.diag(lower))


def misses(recorded: Sensitivity, placements: Placements, theta: Real) -> Real:
    """Errors of the outputs of corrected placements, shape (placements, outputs), in percent."""
    outputs, _ = outputs_and_slopes(recorded.scene, recorded.moved(placements.inputs, theta))
    return 100 * (outputs - placements.targets) / placements.scale


def by_chance(recorded: Sensitivity, placements: Placements) -> float:
    """How likely errors as large as those of the placements would be without any drift.

    Equation: without drift, ``sum e^T S^-1 e`` of uncorrected placements has a chi-squared
    distribution with as many degrees of freedom as there are known outputs.
    """
    found = misses(recorded, placements, np.zeros(2 * placements.inputs.shape[1]))
    inverse = np.linalg.inv(recorded.spread(placements))
    squares = np.einsum("ro,rop,rp->", found, inverse, found)
    return float(chdtrc(found.size, squares))


@dataclass(frozen=True)
class LeftOut:
    """Errors of placements that took no part in the correction, in percent.

    before, after, shape (placements, outputs): Errors without a correction, and with a correction
        that is fitted to all other placements.
    expected, shape (placements, outputs): Expected standard deviations of ``after``.
    spread, shape (placements, outputs): The part of these that does not come from drift.
    """

    before: Real
    after: Real
    expected: Real
    spread: Real

    @property
    def improves(self) -> bool:
        """Whether corrections reduce the errors, each divided by its part that is no drift."""
        before, after = (((part / self.spread) ** 2).sum() for part in (self.before, self.after))
        return bool(after < before)


def left_out(recorded: Sensitivity, placements: Placements, all_of_them: Fit) -> LeftOut:
    """Leave out one placement after another, with all of its readings.

    all_of_them: Fit to all placements, from which the fits without one of them start.
    """
    before = misses(recorded, placements, np.zeros(2 * placements.inputs.shape[1]))
    spread = np.einsum("roo->ro", recorded.spread(placements))
    after, expected = np.empty_like(before), np.empty_like(before)
    tells = recorded.telling(placements)
    for number in range(len(placements)):
        found = fit(recorded, placements.without(number), all_of_them.theta)
        after[number] = misses(recorded, placements, found.theta)[number]
        unsure = ((tells[number] @ found.root) ** 2).sum(axis=1)
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
        # A small weight on the least correction decides between gain and offset where the readings
        # hardly differ.
        matrix = np.vstack([moves[:, [sensor, sensor + sensors]], LEAST_SPAN * np.eye(2)])
        found.append(np.linalg.lstsq(matrix, np.append(missing[:, sensor], [0, 0]))[0])
    return np.concatenate(np.array(found).T)
