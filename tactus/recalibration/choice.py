"""Chooses which placements to make, how many, and how often to read them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from golden.numbers.real import Real
from tactus.recalibration.fit import root_of_inverse
from tactus.recalibration.outlook import Planned, planned
from tactus.recalibration.sensitivity import Sensitivity, spread_out
from tactus.scene import Scene

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
