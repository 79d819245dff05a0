"""Trains, refits and prunes networks of learned functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from golden.numbers.real import Real
from golden.trained.spline_basis import Basis
from tactus.train.objective import Rows
from tactus.train.splines.network import (
    CURVED,
    FLAT,
    STRAIGHT,
    Edges,
    SplineNetwork,
    bends,
    starting,
)
from tactus.train.splines.objective import (
    SQUARES,
    Loss,
    Penalty,
    SplineObjective,
    descend,
    stopped_early,
)

STEPS, PATIENCE, SIZE = 300, 40, 1e-6
# The splines of an input reach beyond its range by this part of it, and by the second number where
# the input is the same in all rows of training. Nothing can be learned of such an input.
MARGIN, ALONE = 0.01, 1.0
# For pruning: how much larger the error on validation rows may be, and the parts of the error of a
# network that an edge may change, of which the largest that does not cost more is taken.
COST = 1.02
PARTS = (1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05)


@dataclass(frozen=True)
class SplineSettings:
    """The settings of one candidate.

    nodes: Hidden sums.
    intervals, hidden_intervals: Of the splines of an input, and of a hidden sum. Where the first is
        0, functions of inputs are straight.
    bend: See ``Penalty``; for as many rows as train.
    size: See ``Penalty``.
    steps, patience: The most evaluations of a descent, and how many points without a better one end
        it.
    loss: What the outputs cost on rows.
    word_error: The error of the word of a hidden sum as a part of its range; see ``WordErrors``.
    """

    nodes: int
    intervals: int
    hidden_intervals: int
    bend: float
    size: float = SIZE
    steps: int = STEPS
    patience: int = PATIENCE
    loss: Loss = SQUARES
    word_error: float = 0.0


@dataclass(frozen=True)
class Learned:
    """A trained network with its edges and the settings that it was trained with.

    rows: The number of rows on which it was trained first, for which the penalty is meant.
    """

    network: SplineNetwork
    edges: Edges
    settings: SplineSettings
    rows: int

    def process(self, frames: Real) -> Real:
        return self.network.process(frames)

    def divided(self, factor: float) -> Learned:
        """The same network, all outputs of which are divided by a factor."""
        network = self.network
        second, biases = network.second / factor, network.biases / factor
        return replace(self, network=replace(network, second=second, biases=biases))

    def error(self, rows: Rows) -> float:
        """The root of its mean loss for each row."""
        errors = self.settings.loss.errors(self.process(rows.inputs), rows)
        return float(np.sqrt((errors**2).sum() / len(errors)))

    @property
    def steps(self) -> int:
        return self.edges.steps

    @property
    def parameters(self) -> int:
        return self.edges.parameters(self.network)

    def descended(self, edges: Edges, rows: Rows, validation: Rows | None = None) -> Learned:
        """Trained further on rows, with these edges; with ``validation`` it may stop early."""
        freedom = edges.freedom(self.network)
        settings = self.settings
        penalty = Penalty(settings.bend * len(rows.inputs) / self.rows, settings.size)
        aim = SplineObjective(
            self.network, rows, penalty, freedom, settings.loss, settings.word_error
        )
        start: Real = np.asarray(
            np.linalg.lstsq(freedom, self.network.packed())[0], dtype=np.float64
        )
        if validation is None:
            point = descend(aim, start, settings.steps)
        else:
            held_back = replace(aim, rows=validation)
            point = stopped_early(aim, start, settings.steps, held_back, settings.patience)
        return Learned(aim.network(point), edges, self.settings, self.rows)


def trained(
    settings: SplineSettings, rng: np.random.Generator, training: Rows, validation: Rows
) -> Learned:
    low, high = training.inputs.min(axis=0), training.inputs.max(axis=0)
    margin = np.where(high > low, MARGIN * (high - low), ALONE)
    # A straight function has splines too; one interval is enough.
    bases = [
        Basis(float(a), float(b), max(1, settings.intervals))
        for a, b in zip(low - margin, high + margin, strict=True)
    ]
    outputs = training.targets.shape[1]
    network = starting(bases, settings.hidden_intervals, settings.nodes, outputs, rng)
    edges = Edges.curved(network.shape)
    kind = CURVED if settings.intervals else STRAIGHT
    edges = replace(edges, first=np.tile(np.where(high > low, kind, FLAT), (settings.nodes, 1)))
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
    of the network, each in the measure of the loss. All others compensate for it.

    error: The error of a network on rows.
    """
    allowed = COST * error(learned, validation)
    present = learned.error(training)
    _, roots = learned.settings.loss.value_gradient_hessian(
        learned.process(training.inputs), training
    )
    # The matrices of each row turn what the outputs change into what the loss does.
    straight, flat = (
        np.sqrt((np.einsum("rqo,ero->erq", roots, change) ** 2).sum(axis=(1, 2)) / len(roots))
        for change in bends(learned.network, training.inputs)
    )
    for part in PARTS:
        edges = learned.edges
        for n in range(len(straight)):
            if straight[n] < part * present:
                edges = edges.with_kind(n, FLAT if flat[n] < part * present else STRAIGHT)
        found = learned.descended(edges, training, validation)
        if error(found, validation) <= allowed:
            return merged(found)
    return merged(learned)


def merged(learned: Learned) -> Learned:
    """The same network, in which all hidden sums with straight functions behind them are one.

    This can be said of networks with one output alone; any other is returned as it is.
    """
    network, edges = learned.network, learned.edges
    (straight,) = np.nonzero(edges.second[0] == STRAIGHT)
    if len(edges.second) > 1 or len(straight) < 2:
        return learned
    centres = network.hidden.centres
    lines = [np.polyfit(centres, network.second[0, h], 1) for h in straight]
    kept = np.delete(np.arange(len(network.first)), straight[1:])
    first, second, kinds = network.first.copy(), network.second.copy(), edges.first.copy()
    one = straight[0]
    first[one] = sum(
        slope * network.first[h] for h, (slope, _) in zip(straight, lines, strict=True)
    )
    second[0, one] = centres
    kinds[one] = edges.first[straight].max(axis=0)
    biases = network.biases + sum(constant for _, constant in lines)
    return replace(
        learned,
        network=replace(network, first=first[kept], second=second[:, kept], biases=biases),
        edges=Edges(kinds[kept], edges.second[:, kept]),
    )
