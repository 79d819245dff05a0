"""What a correction can be expected to gain over the recording, and how surely.

After placements the drift is known to be ``theta``, normal around the likeliest one, ``t``, with
covariance ``C``. With ``M`` of an output as in ``Sensitivity``, what the drift adds to the mean
square of the output's error is

- ``theta^T M theta`` without a correction,
- ``(theta - t)^T M (theta - t)`` with it.

The difference is what the correction gains, ``2 theta^T M t - t^T M t``. It is normal with mean
``t^T M t``, which is never below 0, and standard deviation ``2 sqrt(t^T M C M t)``; the one over
the other tells how likely the output gets better. Before any placement is read ``t`` is normal
around 0 with covariance ``I - C``, and all else is the same.

The errors after placements are those of drifts that are drawn, since outputs bend: each drift says
what the sensors would have given in the recording, and the networks what they make of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from golden.real import Real
from golden.recalibration.fit import Fit, LeftOut, by_chance
from golden.recalibration.placements import Placements
from golden.recalibration.sensitivity import Sensitivity, spread_out

# How likely a correction must gain: over all outputs as two standard deviations say, for each
# output as one says, since what a drift hardly touches never gains surely.
SURE, EACH_SURE = 0.975, 0.84

# How likely the errors of the placements may be without any drift: with more they show none.
BY_CHANCE = 0.01

# Of the drifts that are expected, how many placements must show so surely to be called enough.
ENOUGH = 0.9

# Drifts that are drawn, and rows of the recording that they are tried on at most.
DRAWS, MOST_ROWS = 200, 500

# Of what is known after placements, in squares of the drift that is expected.
LEAST_KNOWN = 1e-9

# Of a gain that is drawn: below it nothing would be left of a sensor.
LEAST_GAIN = 0.1


@dataclass(frozen=True)
class Outlook:
    """What is expected over the recording.

    Attributes
    ----------
    before, after : float array, shape (outputs,)
        Root mean squares of the errors that are expected without and with the correction, percent.
    before_unsure, after_unsure : float array, shape (outputs,)
        Their standard deviations.
    chance, chances : float, and float array, shape (outputs,)
        How likely the correction lowers the mean square of all outputs, and of each.
    """

    before: Real
    after: Real
    before_unsure: Real
    after_unsure: Real
    chance: float
    chances: Real

    @property
    def sure(self) -> bool:
        """Whether the correction surely makes the outputs better."""
        return bool(_sure(np.array([self.chance, *self.chances])))


def helps(recorded: Sensitivity, placements: Placements, found: Fit, left: LeftOut) -> bool:
    """Whether a correction surely helps: placements show a drift, what is left out comes closer,
    and what is expected is surely better. These are three views of it, since each can be wrong: the
    drift is not as it was expected, or the networks err in another way than at random."""
    return (
        by_chance(recorded, placements) < BY_CHANCE
        and left.closer
        and outlook(recorded, found).sure
    )


@dataclass(frozen=True)
class Planned:
    """What is expected over the recording before any placement is read.

    Attributes
    ----------
    before, after : float array, shape (outputs,)
        As in ``Outlook``, from the derivatives.
    sure : float
        Which part of the drifts as they are expected would be corrected surely.
    """

    before: Real
    after: Real
    sure: float

    @property
    def enough(self) -> bool:
        """Whether such placements are called enough."""
        return self.sure >= ENOUGH


def outlook(recorded: Sensitivity, found: Fit) -> Outlook:
    """Of a correction that was fitted to placements."""
    vectors = recorded.scene.vectors()
    rows = spread_out(len(vectors.inputs), MOST_ROWS)
    samples, targets, scale = vectors.inputs[rows], vectors.targets[rows], vectors.scale[rows]
    rng, root = np.random.default_rng(1), np.linalg.cholesky(found.covariance)
    errors = np.empty((2, DRAWS, targets.shape[1]))
    for draw in range(DRAWS):
        theta = found.theta + root @ rng.standard_normal(len(root))
        now = recorded.drifted(samples, theta, LEAST_GAIN)
        for part, given in enumerate((now, recorded.moved(now, found.theta))):
            percent = 100 * (recorded.scene.process_real(given) - targets) / scale
            errors[part, draw] = np.sqrt((percent**2).mean(axis=0))
    before, after = errors
    chance, *chances = _chances(recorded, found.theta[np.newaxis], found.covariance)[0]
    return Outlook(
        before.mean(axis=0),
        after.mean(axis=0),
        before.std(axis=0),
        after.std(axis=0),
        float(chance),
        np.array(chances),
    )


def planned(recorded: Sensitivity, covariance: Real) -> Planned:
    """Of a correction that is still to be fitted, from what will be unsure then."""
    unit, own = np.eye(len(covariance)), recorded.error**2
    before, after = (
        np.sqrt(own + np.einsum("oij,ij->o", recorded.squares, unsure))
        for unsure in (unit, covariance)
    )
    # A little more than I - C, of which rounding may leave less than nothing.
    root = np.linalg.cholesky(unit * (1 + LEAST_KNOWN) - covariance)
    drawn = np.random.default_rng(1).standard_normal((DRAWS, len(unit))) @ root.T
    sure = _sure(_chances(recorded, drawn, covariance))
    return Planned(before, after, float(sure.mean()))


def _sure(chances: Real) -> NDArray[np.bool_]:
    """Whether chances of all outputs and of each, shape (..., 1 + outputs), are enough."""
    needed = np.array([SURE, *[EACH_SURE] * (chances.shape[-1] - 1)])
    return np.asarray((chances >= needed).all(axis=-1))


def _chances(recorded: Sensitivity, thetas: Real, covariance: Real) -> Real:
    """How likely corrections make all outputs, and each, better.

    Parameters
    ----------
    recorded : Sensitivity
    thetas : float array, shape (corrections, 2 sensors)
    covariance : float array, shape (2 sensors, 2 sensors)

    Returns
    -------
    float array, shape (corrections, 1 + outputs)
    """
    each = recorded.squares
    reach = thetas @ np.concatenate([each.mean(axis=0)[np.newaxis], each])
    gain = np.einsum("ocj,cj->co", reach, thetas)
    unsure = 2 * np.sqrt(np.einsum("oci,ij,ocj->co", reach, covariance, reach, optimize=True))
    # Where nothing can change, nothing gets worse.
    parts = np.divide(gain, unsure, out=np.full(gain.shape, np.inf), where=unsure > 0)
    result: Real = ndtr(parts)
    return result
