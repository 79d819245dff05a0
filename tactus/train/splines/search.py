"""``make train`` for networks of learned functions: the search, the choice and pruning.

docs/learned-functions.md says how. A candidate has a number of hidden sums, a number of intervals
of each input, a stiffness of its functions, and a random start.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import floor, log2
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from golden.trained.function import HIGH
from golden.trained.function_network import Edge, FunctionNetwork
from golden.trained.spline_basis import Basis
from tactus.scene import Scene
from tactus.scene.scale import Scale, on_readings
from tactus.train import search
from tactus.train.objective import Rows, normal_equations
from tactus.train.search import Result
from tactus.train.splines.network import (
    CURVED,
    FLAT,
    STRAIGHT,
    Edges,
    SplineNetwork,
    bends,
    starting,
)
from tactus.train.splines.objective import SplineObjective
from tactus.train.task import Frames, Task, as_read, bit_true_error, shift_biases

# Intervals of the splines of a hidden sum.
HIDDEN_INTERVALS = 4
# The penalties on bends that are tried, and those for classes: the cross-entropy of a row is larger
# than the square of an error.
BENDS = (0.01, 0.03, 0.1)
CLASS_BENDS = (0.1, 0.3, 1.0)

# The splines of an input reach beyond its range by this part of it, and by the second number where
# the input is the same in all rows of training. Nothing can be learned of such an input.
MARGIN, ALONE = 0.01, 1.0
# For pruning: how much larger the error on validation rows may be, and the parts of the error of a
# network that an edge may change, of which the largest that does not cost more is taken.
COST = 1.02
PARTS = (1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05)


def candidates(task: Task) -> list[tuple[tuple[int], int]]:
    """The hidden sums and the number of every candidate, the smallest networks first."""
    hidden = task.scene.members[task.number].hidden
    low, high = (hidden, hidden) if hidden else task.scene.training.hidden
    return [((h,), n) for h in range(low, high + 1) for n in range(len(choices(task.scene)))]


def choices(scene: Scene) -> list[tuple[int, float, int]]:
    """Intervals of an input, penalty and random start of each candidate with the same sums."""
    settings = scene.training
    bends = CLASS_BENDS if scene.labels else BENDS
    return list(product(settings.intervals, bends, range(settings.restarts)))


def train(task: Task, layers: tuple[int], number: int) -> Learned:
    (hidden,) = layers
    intervals, bend, start = choices(task.scene)[number]
    scene, own = task.scene, task.scene.training
    rng = np.random.default_rng([own.seed, task.number, hidden, start])
    descent = own.weight_decay, own.steps, own.patience
    word_error = 0.0
    if not scene.labels:
        inputs, design = task.training.inputs.shape[1], DESIGNS.get(scene.design, Design)
        word_error = design.word_error(inputs, scene.design_options)
    settings = SplineSettings(hidden, intervals, bend, *descent, word_error)
    return trained(settings, rng, task.training, task.validation)


def as_layers(task: Task, learned: Learned, frames: Frames) -> DenseNetwork:
    """A network for hardware, with the constants of its outputs as these frames want them.

    If the scene has classes, its outputs are logits, which nothing shifts.
    """
    earlier = frames.inputs.shape[1] - task.scene.members[0].inputs
    # A design for learned functions alone has no multiplier.
    products = not DESIGNS.get(task.scene.design, Design).learned_functions
    network = function_network(learned, frames.inputs, earlier, products).layers()
    if not task.scene.labels:
        return shift_biases(task, network, frames)
    # The functions have to fill the words of logits as the network is read. They are made again in
    # this measure, and the last layer has the weights for it.
    file, _ = as_read(task, network)
    scale = task.scene.scales_as_read(file, task.number)[1][0]
    divided = learned.divided(scale.factor)
    network = function_network(divided, frames.inputs, earlier, products).layers()
    outputs = [scale] * network.shape[-1]
    return on_readings(network, [Scale()] * network.shape[0], outputs)


def measure(task: Task, layers: tuple[int], number: int) -> Result:
    try:
        _, network = as_read(task, as_layers(task, train(task, layers, number), task.training))
        validation, test = (
            bit_true_error(task, network, part) for part in (task.validation, task.test)
        )
    except InputError as error:
        return Result(layers, number, refused=str(error))
    return Result(layers, number, validation, test)


@dataclass
class Stages(search.Stages):
    """The stages in which training makes a scene's networks of learned functions."""

    edges: list[dict[str, int]] = field(default_factory=list)

    def trained(self, tasks: list[Task], *candidate: Any) -> list[Any]:
        task, seen_more, seen_all = tasks
        found = train(task, *candidate)
        found = pruned(found, task.training, task.validation)
        kinds = found.edges.kinds.tolist()
        self.edges.append({"curved_edges": kinds.count(2), "straight_edges": kinds.count(1)})
        networks: list[Any] = [as_layers(task, found, task.training)] * 3
        if self.scene.training.refit:
            networks[1:] = (
                as_layers(seen, found.descended(found.edges, frames, frames), frames)
                for seen, frames in ((seen_more, seen_more.known), (seen_all, seen_all.every))
            )
        return networks


@dataclass(frozen=True)
class SplineSettings:
    """The settings of one candidate.

    nodes: Hidden sums.
    intervals: Of the splines of an input; with 0, functions of inputs are straight.
    bend, size: See ``SplineObjective``; ``bend`` is for as many rows as train.
    steps, patience: The most evaluations of a descent, and how many points without a better one end
        it.
    word_error: The error of the word of a hidden sum as a part of its range.
    """

    nodes: int
    intervals: int
    bend: float
    size: float = 1e-6
    steps: int = 300
    patience: int = 40
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
        errors = rows.errors(self.process(rows.inputs))
        return float(np.sqrt((errors**2).sum() / len(errors)))

    def descended(self, edges: Edges, rows: Rows, validation: Rows) -> Learned:
        """Trained further on rows, with these edges, until the error on others falls no more."""
        freedom, own = edges.freedom(self.network), self.settings
        bend = own.bend * len(rows.inputs) / self.rows
        watched = self.network, rows, validation, own.patience
        aim = SplineObjective(*watched, bend, own.size, freedom, own.word_error)
        start: Real = np.asarray(np.linalg.lstsq(freedom, self.network.packed())[0], np.float64)
        point = aim.search(normal_equations, start, own.steps)
        return replace(self, network=aim.network(point), edges=edges)


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
    network = starting(bases, HIDDEN_INTERVALS, settings.nodes, outputs, rng)
    edges = Edges.curved(network.shape)
    kind = CURVED if settings.intervals else STRAIGHT
    edges = replace(edges, first=np.tile(np.where(high > low, kind, FLAT), (settings.nodes, 1)))
    first = Learned(network, edges, settings, len(training.inputs))
    return first.descended(edges, training, validation)


def pruned(learned: Learned, training: Rows, validation: Rows) -> Learned:
    """A network with edges that are straight or flat where this costs next to nothing.

    An edge becomes straight, or flat, if that changes the outputs by less than a part of the error
    of the network, each in the measure of the loss. All others compensate for it.
    """
    allowed = COST * learned.error(validation)
    present = learned.error(training)
    roots = training.roots(learned.process(training.inputs))
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
        if found.error(validation) <= allowed:
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


# With the inputs of training, functions fill this part of their range at most, and so do sums where
# hardware has no products. Beyond it, a function is level.
FILLED = 0.8
# The part that hidden sums fill where hardware has products.
FILLED_WORD = 0.9
# The range of a function that is added to a hidden sum.
MOST_HIDDEN = 0.99 * HIGH
# A product may be so much larger than a word, because it is added up before anything is rounded. A
# larger one would take many steps: each holds a part of its weight.
LARGER = 16.0
# A sum that hardly changes is not made larger without end.
LEAST = 2.0**-10


def function_network(
    learned: Learned, inputs: Real, earlier: int, products: bool = True
) -> FunctionNetwork:
    """A trained network with what hardware must know.

    Where hardware has products, the middle of what a hidden sum reaches becomes 0, and a scale
    makes it fill the word, so that the segments of a table of it are narrow. Where every edge is a
    table of a few bits, a word that is filled more takes more LUTs: those of digit-tables would
    take 1222 and not 1183, with the same errors.

    A function goes straight on beyond the range in which it was trained, until it would leave the
    format of its sum; from there it is level.

    inputs, shape (rows, inputs): The inputs of training.
    earlier: How many of the inputs, at the end, are outputs of earlier networks.
    products: Whether hardware multiplies, so that a straight line is no table.
    """
    network, edges = learned.network, learned.edges
    sums = network.sums(network.spread(inputs))
    first, offsets, scales, hidden, around = [], [], [], [], []
    for kinds, rows, sum_ in zip(edges.first, network.first, sums.T, strict=True):
        centred, constant = _centred(kinds, network.bases, rows)
        reached = [
            _reached(basis, row, x) / (LARGER if products and kind == STRAIGHT else 1)
            for kind, basis, row, x in zip(kinds, network.bases, centred, inputs.T, strict=True)
        ]
        middle = float(sum_.max() + sum_.min()) / 2 if products else 0.0
        around.append(sum_ - middle)
        largest = max(*reached, float(np.abs(around[-1]).max()), LEAST)
        # A scale that is a power of two changes no bit of a slope.
        power = 2.0 ** floor(log2(FILLED * HIGH / largest))
        scales.append(FILLED_WORD * HIGH / largest if products else power)
        first.append(
            [
                _edge(kind, basis, row, MOST_HIDDEN / scales[-1])
                for kind, basis, row in zip(kinds, network.bases, centred, strict=True)
            ]
        )
        offsets.append(constant - middle)
        ends = network.hidden.low - middle, network.hidden.high - middle
        hidden.append(Basis(*ends, network.hidden.intervals))
    biases = network.biases.copy()
    second = []
    for o, (kinds, rows) in enumerate(zip(edges.second, network.second, strict=True)):
        centred, constant = _centred(kinds, hidden, rows)
        biases[o] += constant
        second.append(
            [
                _edge(kind, basis, row, _reached(basis, row, x) / FILLED)
                for kind, basis, row, x in zip(kinds, hidden, centred, around, strict=True)
            ]
        )
    return FunctionNetwork(
        first, second, biases.tolist(), scales, earlier, offsets, products=products
    )


def _reached(basis: Basis, coefficients: Real, x: Real) -> float:
    """The largest magnitude of a function, over its range and over some inputs."""
    values = np.abs(basis.function(x, coefficients)).max()
    return max(float(values), float(np.abs(coefficients).max()), LEAST)


def _centred(
    kinds: Sequence[int], bases: Sequence[Basis], rows: Sequence[Real]
) -> tuple[list[Real], float]:
    """The coefficients of the edges of a sum without their constants, and the constants together.

    The constant of a straight edge is its value where its input is 0.
    """
    constants = [
        float(np.polyfit(basis.centres, row, 1)[1] if kind == STRAIGHT else row.mean())
        for kind, basis, row in zip(kinds, bases, rows, strict=True)
    ]
    centred = [row - constant for row, constant in zip(rows, constants, strict=True)]
    return centred, float(sum(constants))


def _edge(kind: int, basis: Basis, coefficients: Real, most: float) -> Edge:
    """An edge whose values stay within -most and most."""
    if kind == CURVED:
        return basis.low, basis.high, most, *coefficients.tolist()
    if kind == STRAIGHT:
        return float(np.polyfit(basis.centres, coefficients, 1)[0])
    return None
