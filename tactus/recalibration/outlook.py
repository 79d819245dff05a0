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

The errors that are expected after a correction follow from ``C``. So does a part of those without
one. The other part is computed at the most likely drift, because the outputs are not linear: it
determines the readings that the sensors would have given in the recording, and the networks compute
the outputs for them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import NamedTuple

import numpy as np
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

# The number of drifts that are drawn.
DRAWS = 200

# The least variance that placements explain, in squares of the expected drift.
LEAST_KNOWN = 1e-9

# The least gain of a correction that is inverted. Below it, nothing would be left of a sensor.
LEAST_GAIN = 0.1


@dataclass(frozen=True)
class Outlook:
    """The expectation over the recording for one correction, or for several that may come.

    before, after, shape (outputs,): Expected root mean square errors without and with a correction,
        in percent.
    chances, shape (corrections, 1 + outputs): Probability that each correction lowers the mean
        square of all outputs, and of each output.
    """

    before: Real
    after: Real
    chances: Real

    @property
    def enough(self) -> bool:
        """Whether enough of the corrections surely improve the outputs."""
        needed = np.array([SURE, *[EACH_SURE] * len(self.after)])
        return bool((self.chances >= needed).all(axis=1).mean() >= ENOUGH)


def helps(recorded: Sensitivity, placements: Placements, found: Fit, left: LeftOut) -> bool:
    """Whether a correction surely helps.

    Three conditions must hold: the placements show a drift, the placements that are left out get
    closer, and the expected outputs are surely better. Each condition alone can be wrong, if the
    drift is not as expected, or if the errors of the networks are not random.
    """
    return (
        by_chance(recorded, placements) < BY_CHANCE
        and left.improves
        and outlook(recorded, found).enough
    )


def outlook(recorded: Sensitivity, found: Fit) -> Outlook:
    """The expectation for a correction that was fitted to placements."""
    vectors = recorded.scene.vectors()
    now = recorded.drifted(vectors.inputs, found.theta, LEAST_GAIN)
    errors = vectors.percent_errors(recorded.scene.process_real(now))
    unsure = found.root @ found.root.T
    return Outlook(
        _expected(recorded, (errors**2).mean(axis=0), unsure),
        _expected(recorded, recorded.error**2, unsure),
        _chances(recorded, found.theta[np.newaxis], found.root),
    )


def planned(recorded: Sensitivity, root: Real) -> Outlook:
    """The expectation before any placement is read, with the later ``Fit.root``."""
    unit, covariance = np.eye(len(root)), root @ root.T
    # This is slightly more than I - C, because rounding may make an eigenvalue of I - C negative.
    known = np.linalg.cholesky(unit * (1 + LEAST_KNOWN) - covariance)
    drawn = np.random.default_rng(1).standard_normal((DRAWS, len(unit))) @ known.T
    own = recorded.error**2
    before, after = (_expected(recorded, own, unsure) for unsure in (unit, covariance))
    return Outlook(before, after, _chances(recorded, drawn, root))


def _expected(recorded: Sensitivity, squares: Real, covariance: Real) -> Real:
    """Root mean square errors, from mean squares at the likeliest drift and its covariance."""
    return np.asarray(np.sqrt(squares + np.einsum("oij,ij->o", recorded.squares, covariance)))


def _chances(recorded: Sensitivity, thetas: Real, root: Real) -> Real:
    """``Outlook.chances`` of corrections, shape (corrections, 2 sensors), with ``Fit.root``."""
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


class Proposed(NamedTuple):
    """A row of the recording as a placement, and what is expected with it and those before it."""

    row: int
    expected: Outlook


def proposed(recorded: Sensitivity, times: int = 1) -> Iterator[Proposed]:
    """Rows of the recording, in the order in which they reduce the expected error most.

    The next row is always the one that makes the expected mean square error over the recording,
    averaged over all outputs, the least: ``tr(M C)``. With a placement, ``C`` becomes ``C - C J^T
    (S + J C J^T)^-1 J C``. These differences say which row is best; its ``C`` is computed from all
    chosen rows, because differences lose digits. No row is proposed twice, because the network's
    own error there would count twice.

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


class Plan(NamedTuple):
    """The proposed placements that ensure a gain, and how often to read each of them."""

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
