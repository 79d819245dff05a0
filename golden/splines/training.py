"""Trains, refits and prunes networks of learned functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from golden.real import Real
from golden.spline_basis import Basis
from golden.splines.descent import descend, stopped_early
from golden.splines.edges import FLAT, STRAIGHT, Edges, bends
from golden.splines.network import SplineNetwork, starting
from golden.splines.objective import Penalty, SplineObjective
from golden.training.objective import Rows

STEPS, PATIENCE, SIZE = 300, 40, 1e-6
# The splines of an input reach beyond its range by this part of it.
MARGIN = 0.01
# For pruning: how much larger the error on validation rows may be, and the parts of the error of a
# network that an edge may change, of which the largest that does not cost more is taken.
COST = 1.02
PARTS = (1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05)


@dataclass(frozen=True)
class SplineSettings:
    """The settings of one candidate.

    Attributes
    ----------
    nodes : int
        Hidden sums.
    intervals, hidden_intervals : int
        Of the splines of an input, and of a hidden sum.
    bend : float
        See ``Penalty``; for as many rows as train.
    size : float
        See ``Penalty``.
    steps, patience : int
        The most evaluations of a descent, and how many points without a better one end it.
    word_error : float
        The error of the word of a hidden sum as a part of its range; see ``WordErrors``.
    """

    nodes: int
    intervals: int
    hidden_intervals: int
    bend: float
    size: float = SIZE
    steps: int = STEPS
    patience: int = PATIENCE
    word_error: float = 0.0


@dataclass(frozen=True)
class Learned:
    """A trained network with its edges and the settings that it was trained with.

    Attributes
    ----------
    network : SplineNetwork
    edges : Edges
    settings : SplineSettings
    rows : int
        The number of rows on which it was trained first, for which the penalty is meant.
    """

    network: SplineNetwork
    edges: Edges
    settings: SplineSettings
    rows: int

    def process(self, frames: Real) -> Real:
        """Outputs, shape (frames, outputs)."""
        return self.network.process(frames)

    @property
    def steps(self) -> int:
        """The steps on an engine."""
        return self.edges.steps

    @property
    def parameters(self) -> int:
        """The numbers that define it."""
        return self.edges.parameters(self.network)

    def descended(self, edges: Edges, rows: Rows, validation: Rows | None = None) -> Learned:
        """Trained further on rows, with these edges; with ``validation`` it may stop early."""
        freedom = edges.freedom(self.network)
        settings = self.settings
        penalty = Penalty(settings.bend * len(rows.inputs) / self.rows, settings.size)
        aim = SplineObjective(self.network, rows, penalty, freedom, settings.word_error)
        start: Real = np.asarray(
            np.linalg.lstsq(freedom, self.network.packed())[0], dtype=np.float64
        )
        if validation is None:
            point = descend(aim, start, settings.steps)
        else:
            held_back = SplineObjective(self.network, validation, penalty, freedom)
            point = stopped_early(aim, start, settings.steps, held_back, settings.patience)
        return Learned(aim.network(point), edges, self.settings, self.rows)


def trained(
    settings: SplineSettings, rng: np.random.Generator, training: Rows, validation: Rows
) -> Learned:
    """The network of one candidate."""
    low, high = training.inputs.min(axis=0), training.inputs.max(axis=0)
    margin = MARGIN * (high - low)
    bases = [
        Basis(float(a), float(b), settings.intervals)
        for a, b in zip(low - margin, high + margin, strict=True)
    ]
    outputs = training.targets.shape[1]
    network = starting(bases, settings.hidden_intervals, settings.nodes, outputs, rng)
    edges = Edges.curved(network.shape)
    first = Learned(network, edges, settings, len(training.inputs))
    return first.descended(edges, training, validation)


def refitted(learned: Learned, rows: Rows) -> Learned:
    """Trained further on more rows, with the same edges."""
    return learned.descended(learned.edges, rows)


def pruned(
    learned: Learned, training: Rows, validation: Rows, error: Callable[[Learned, Rows], float]
) -> Learned:
    """A network with edges that are straight or flat where this costs next to nothing.

    An edge becomes straight, or flat, if that changes the outputs by less than a part of the error
    of the network. All others compensate for it.

    Parameters
    ----------
    learned : Learned
    training, validation : Rows
    error : callable
        The error of a network on rows.
    """
    rms = float(np.sqrt((_scaled(learned, training) ** 2).mean()))
    allowed = COST * error(learned, validation)
    changes = bends(learned.network, training.inputs)
    straight, flat = (
        np.sqrt(((change / training.scale) ** 2).mean(axis=(1, 2))) for change in changes
    )
    for part in PARTS:
        edges = learned.edges
        for n in range(len(straight)):
            if straight[n] < part * rms:
                edges = edges.with_kind(n, FLAT if flat[n] < part * rms else STRAIGHT)
        found = learned.descended(edges, training, validation)
        if error(found, validation) <= allowed:
            return found
    return learned


def _scaled(learned: Learned, rows: Rows) -> Real:
    return np.asarray((learned.process(rows.inputs) - rows.targets) / rows.scale)
