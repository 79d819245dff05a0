"""The gain that a correction promises, how sure it is, and which placements to make for it.

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

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from golden.numbers.real import Real
from tactus.recalibration.fit import Fit, LeftOut, by_chance, root_of_inverse
from tactus.recalibration.sensitivity import Placements, Sensitivity, spread_out
from tactus.scene import Scene

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


# Limits of a plan. With only one placement, none could be left out.
LEAST_PLACEMENTS, MOST_PLACEMENTS = 2, 24
REPEATS = (1, 2, 4, 8, 16)

# The most rows of the recording that are compared with each other.
MOST_CANDIDATES = 500


@dataclass(frozen=True)
class Proposed:
    """A placement that is proposed.

    row: Row of the recording, from 0.
    expected: The expectation with this placement and those before it.
    """

    row: int
    expected: Planned


def proposed(recorded: Sensitivity, times: int = 1) -> Iterator[Proposed]:
    """Rows of the recording, in the order in which they reduce the expected error most.

    The next row is always the one that makes the expected mean square error over the recording,
    averaged over all outputs, the least: ``tr(M C)`` of ``tactus.recalibration.outlook``. With a
    placement, ``C`` becomes ``C - C J^T (S + J C J^T)^-1 J C``. These differences say which row is
    best; its ``C`` is computed from all chosen rows, because differences lose digits. No row is
    proposed twice, because the network's own error there would count twice.

    times: How often each placement will be read.
    """
    rows = spread_out(len(recorded.recorded), MOST_CANDIDATES)
    there = recorded.recorded.at(rows)
    spread = recorded.spread(replace(there, times=there.times * times))
    tells = recorded.tells[rows]
    squares = recorded.squares.mean(axis=0)
    root = np.eye(tells.shape[2])
    known = root
    whitened = np.linalg.solve(np.linalg.cholesky(spread), tells)
    left = np.zeros(len(tells))
    while np.isfinite(left).any():
        told = tells @ root
        reach = told @ root.T
        inner = np.linalg.inv(spread + told @ told.transpose(0, 2, 1))
        lowered = np.einsum("roi,rop,rpj,ij->r", reach, inner, reach, squares, optimize=True)
        part = lowered / np.sum(squares * (root @ root.T))
        # The numbers are rounded, so that of two equal ones every machine takes the first.
        best = int((part.round(6) + left).argmax())
        left[best] = -np.inf
        known = np.concatenate([known, whitened[best]])
        root = root_of_inverse(known)
        yield Proposed(int(rows[best]), planned(recorded, root))


@dataclass(frozen=True)
class Plan:
    """How many of the proposed placements ensure a gain, and how often to read each of them."""

    placements: Sequence[Proposed]
    times: int


def plan(recorded: Sensitivity) -> Plan | None:
    """The fewest readings with which nearly all expected drifts are surely corrected.

    Returns: None where even ``MOST_PLACEMENTS`` placements, read most often, are not enough because
        the networks' own errors hide such a drift.
    """
    found: list[Plan] = []
    for times in REPEATS if recorded.noise.any() else REPEATS[:1]:
        rows: list[Proposed] = []
        for one in islice(proposed(recorded, times), MOST_PLACEMENTS):
            rows.append(one)
            if len(rows) >= LEAST_PLACEMENTS and one.expected.enough:
                found.append(Plan(rows, times))
                break
    return min(found, key=lambda one: len(one.placements) * one.times, default=None)


def placement(scene: Scene, targets: Real) -> str:
    """A text with the known outputs of a placement, which are given as signals."""
    values = scene.in_units(targets)
    return ", ".join(f"{n} {v:g}" for n, v in zip(scene.outputs, values, strict=True))
