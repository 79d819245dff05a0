"""Which placements to make, how many, and how often to read them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from golden.real import Real
from golden.recalibration.outlook import Planned, planned
from golden.recalibration.sensitivity import Sensitivity, spread_out
from golden.scene import Scene

# What a plan may ask for. Of one placement alone nothing can be left out.
LEAST_PLACEMENTS, MOST_PLACEMENTS = 2, 24
REPEATS = (1, 2, 4, 8, 16)

# Rows of the recording that are weighed against each other.
MOST_CANDIDATES = 500


@dataclass(frozen=True)
class Proposed:
    """A placement to make.

    Attributes
    ----------
    row : int
        Of the recording, from 0.
    expected : Planned
        What is expected with it and those before it.
    """

    row: int
    expected: Planned


def proposed(recorded: Sensitivity, times: int = 1) -> Iterator[Proposed]:
    """Rows of the recording in the order in which they lower the expected error most.

    Each is the one after which the mean square error that is expected over the recording, the mean
    of all outputs, is least: ``tr(M C)`` of ``golden.recalibration.outlook``. With a placement
    ``C`` becomes ``C - C J^T (S + J C J^T)^-1 J C``. No row comes again: what its network errs
    there would count twice.

    Parameters
    ----------
    recorded : Sensitivity
    times : int
        How often each placement is to be read.
    """
    rows = spread_out(len(recorded.recorded), MOST_CANDIDATES)
    there = recorded.recorded.at(rows)
    spread = recorded.spread(replace(there, times=there.times * times))
    tells = recorded.tells[rows]
    squares = recorded.squares.mean(axis=0)
    covariance = np.eye(tells.shape[2])
    left = np.zeros(len(tells))
    while np.isfinite(left).any():
        reach = tells @ covariance
        inner = np.linalg.inv(spread + reach @ tells.transpose(0, 2, 1))
        lowered = np.einsum("roi,rop,rpj,ij->r", reach, inner, reach, squares, optimize=True)
        part = lowered / np.sum(squares * covariance)
        # Rounded, so that of two that tell as much the first is taken on every machine.
        best = int((part.round(6) + left).argmax())
        left[best] = -np.inf
        covariance = covariance - reach[best].T @ inner[best] @ reach[best]
        yield Proposed(int(rows[best]), planned(recorded, covariance))


@dataclass(frozen=True)
class Plan:
    """How many of the proposed placements make a gain sure, and how often they are to be read."""

    placements: Sequence[Proposed]
    times: int


def plan(recorded: Sensitivity) -> Plan | None:
    """The fewest readings from which drifts as they are expected are nearly all surely corrected.

    Returns
    -------
    Plan or None
        None where even ``MOST_PLACEMENTS`` placements, read most often, are not enough: what the
        networks err of themselves hides such a drift.
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
    """Known outputs, as signals, in words."""
    values = scene.in_units(targets)
    return ", ".join(f"{n} {v:g}" for n, v in zip(scene.outputs, values, strict=True))
