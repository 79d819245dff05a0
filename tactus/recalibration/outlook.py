"""The gain that can be expected from a correction over the recording, and how sure it is.

After placements the drift ``theta`` has a normal distribution around the most likely drift ``t``
with covariance ``C``. With ``M`` of an output as in ``Sensitivity``, the drift adds to the mean
square of the output's error

- ``theta^T M theta`` without a correction,
- ``(theta - t)^T M (theta - t)`` with it.

The difference is the gain of the correction, ``2 theta^T M t - t^T M t``. It has a normal
distribution with mean ``t^T M t``, which is never below 0, and standard deviation ``2 sqrt(t^T M C
M t)``. The ratio of the two determines how likely the output gets better. Before any placement is
read, ``t`` has a normal distribution around 0 with covariance ``I - C``, and everything else is the
same.

The errors after placements are computed for randomly drawn drifts, because the outputs are not
linear. Each drift determines the readings that the sensors would have given in the recording, and
the networks compute the outputs for them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from golden.numbers.real import Real
from tactus.recalibration.fit import Fit, LeftOut, by_chance
from tactus.recalibration.placements import Placements
from tactus.recalibration.sensitivity import Sensitivity, spread_out

# How likely a gain must be: over all outputs as likely as two standard deviations, and for each
# output as likely as one, because the gain of an output that a drift hardly changes is never sure.
SURE, EACH_SURE = 0.975, 0.84

# The errors of the placements show a drift if they would be less likely than this without one.
BY_CHANCE = 0.01

# Placements are called enough if they surely correct this part of the expected drifts.
ENOUGH = 0.9

# The number of drifts that are drawn, and the most rows of the recording on which they are tried.
DRAWS, MOST_ROWS = 200, 500

# The least variance that placements explain, in squares of the expected drift.
LEAST_KNOWN = 1e-9

# The least gain that is drawn. Below it, nothing would be left of a sensor.
LEAST_GAIN = 0.1


@dataclass(frozen=True)
class Outlook:
    """The expectation over the recording.

    before, after, shape (outputs,): Expected root mean square errors without and with the
        correction, in percent.
    before_unsure, after_unsure, shape (outputs,): The standard deviations of these errors.
    chance, chances, shape (outputs,): Probability that the correction lowers the mean square of all
        outputs, and of each output.
    """

    before: Real
    after: Real
    before_unsure: Real
    after_unsure: Real
    chance: float
    chances: Real

    @property
    def sure(self) -> bool:
        """Whether the correction surely improves the outputs."""
        return bool(_sure(np.array([self.chance, *self.chances])))


def helps(recorded: Sensitivity, placements: Placements, found: Fit, left: LeftOut) -> bool:
    """Whether a correction surely helps.

    Three conditions must hold: the placements show a drift, the placements that are left out get
    closer, and the expected outputs are surely better. Each condition alone can be wrong, if the
    drift is not as expected, or if the errors of the networks are not random.
    """
    return (
        by_chance(recorded, placements) < BY_CHANCE
        and left.improves
        and outlook(recorded, found).sure
    )


@dataclass(frozen=True)
class Planned:
    """The expectation over the recording before any placement is read.

    before, after, shape (outputs,): As in ``Outlook``, but computed from the derivatives.
    sure: The part of the expected drifts that would surely be corrected.
    """

    before: Real
    after: Real
    sure: float

    @property
    def enough(self) -> bool:
        """Whether these placements are called enough."""
        return self.sure >= ENOUGH


def outlook(recorded: Sensitivity, found: Fit) -> Outlook:
    """The expectation for a correction that was fitted to placements."""
    vectors = recorded.scene.vectors()
    rows = spread_out(len(vectors.inputs), MOST_ROWS)
    samples, targets, scale = vectors.inputs[rows], vectors.targets[rows], vectors.scale[rows]
    rng, root = np.random.default_rng(1), found.root
    errors = np.empty((2, DRAWS, targets.shape[1]))
    for draw in range(DRAWS):
        theta = found.theta + root @ rng.standard_normal(len(root))
        now = recorded.drifted(samples, theta, LEAST_GAIN)
        for part, given in enumerate((now, recorded.moved(now, found.theta))):
            percent = 100 * (recorded.scene.process_real(given) - targets) / scale
            errors[part, draw] = np.sqrt((percent**2).mean(axis=0))
    before, after = errors
    chance, *chances = _chances(recorded, found.theta[np.newaxis], root)[0]
    return Outlook(
        before.mean(axis=0),
        after.mean(axis=0),
        before.std(axis=0),
        after.std(axis=0),
        float(chance),
        np.array(chances),
    )


def planned(recorded: Sensitivity, root: Real) -> Planned:
    """The expectation for a correction that is still to be fitted, with its later ``Fit.root``."""
    unit, own = np.eye(len(root)), recorded.error**2
    covariance = root @ root.T
    before, after = (
        np.sqrt(own + np.einsum("oij,ij->o", recorded.squares, unsure))
        for unsure in (unit, covariance)
    )
    # This is slightly more than I - C, because rounding may make an eigenvalue of I - C negative.
    known = np.linalg.cholesky(unit * (1 + LEAST_KNOWN) - covariance)
    drawn = np.random.default_rng(1).standard_normal((DRAWS, len(unit))) @ known.T
    sure = _sure(_chances(recorded, drawn, root))
    return Planned(before, after, float(sure.mean()))


def _sure(chances: Real) -> NDArray[np.bool_]:
    """Whether the probabilities for all outputs and for each, shape (..., 1 + outputs), suffice."""
    needed = np.array([SURE, *[EACH_SURE] * (chances.shape[-1] - 1)])
    return np.asarray((chances >= needed).all(axis=-1))


def _chances(recorded: Sensitivity, thetas: Real, root: Real) -> Real:
    """The probabilities that corrections improve all outputs together, and each output.

    thetas: shape (corrections, 2 sensors).
    root, shape (2 sensors, 2 sensors): ``Fit.root``.

    Returns: shape (corrections, 1 + outputs).
    """
    each = recorded.squares
    reach = thetas @ np.concatenate([each.mean(axis=0)[np.newaxis], each])
    gain = np.einsum("ocj,cj->co", reach, thetas)
    unsure = 2 * np.linalg.norm(reach @ root, axis=2).T
    # An output that cannot change cannot get worse either.
    parts = np.divide(gain, unsure, out=np.full(gain.shape, np.inf), where=unsure > 0)
    return ndtr(parts)
