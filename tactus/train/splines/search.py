"""``make train`` for networks of learned functions: the search, the choice and pruning.

A candidate has a number of hidden sums, a number of intervals of each input, a stiffness of its
functions, and a random start (``tactus.train.splines``). It is trained with what the design says of
how exact its hidden words are. The one with the least bit-true error on the validation rows is
chosen; where the scene has classes, that is the one with the fewest wrong decisions, and hidden
words count as exact. Then edges become straight, or are left out, where that costs next to nothing,
and with ``training.refit`` the network is trained on with more rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from math import floor, log2
from typing import Any, cast

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
from tactus.train.search import Result
from tactus.train.splines import training as splines
from tactus.train.splines.network import CURVED, STRAIGHT
from tactus.train.splines.objective import SQUARES, CrossEntropy, Loss
from tactus.train.splines.training import Learned, SplineSettings
from tactus.train.task import Frames, Task, as_read, bit_true_error, shift_biases

# Intervals of the splines of a hidden sum.
HIDDEN_INTERVALS = 4
# The penalties on bends that are tried, and those for classes: the cross-entropy of a row is larger
# than the square of an error.
BENDS = (0.01, 0.03, 0.1)
CLASS_BENDS = (0.1, 0.3, 1.0)


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
    own = task.scene.training
    rng = np.random.default_rng([own.seed, task.number, hidden, start])
    descent = own.weight_decay, own.steps, own.patience
    loss, word_error = _aim(task.scene, task.training.inputs.shape[1])
    settings = SplineSettings(hidden, intervals, HIDDEN_INTERVALS, bend, *descent, loss, word_error)
    return splines.trained(settings, rng, task.training, task.validation)


def _aim(scene: Scene, inputs: int) -> tuple[Loss, float]:
    """What a training minimises, and how far hidden words are from their sums."""
    if scene.labels:
        return CrossEntropy(), 0.0
    design = DESIGNS.get(scene.design, Design)
    return SQUARES, design.word_error(inputs, scene.design_options)


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
    scale = class_scale(task, network)
    divided = learned.divided(scale.factor)
    network = function_network(divided, frames.inputs, earlier, products).layers()
    outputs = [scale] * network.shape[-1]
    return on_readings(network, [Scale()] * network.shape[0], outputs)


def class_scale(task: Task, network: DenseNetwork) -> Scale:
    """The scale of the logits of a network when it is read from its file."""
    file, _ = as_read(task, network)
    return task.scene.scales_as_read(file, task.number)[1][0]


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

    def add(self, *candidate: Any) -> None:
        task = self.task(self.chosen, len(self.chosen))
        found = train(task, *candidate)
        found = splines.pruned(found, task.training, task.validation, Learned.error)
        stages: list[Any] = [(self.chosen, found, task.training, task)]
        if self.scene.training.refit:
            for networks, part in ((self.tested, "known"), (self.written, "every")):
                own = self.task(networks, len(self.chosen))
                frames = getattr(own, part)
                stages.append((networks, splines.refitted(found, frames), frames, own))
        else:
            stages += [(self.tested, *stages[0][1:]), (self.written, *stages[0][1:])]
        made = [as_read(own, as_layers(own, one, frames)) for _, one, frames, own in stages]
        for (networks, *_), (_, read) in zip(stages, made, strict=True):
            networks.append(read)
        self.files.append(cast(Any, made[-1][0]))
        kinds = found.edges.kinds.tolist()
        self.edges.append({"curved_edges": kinds.count(2), "straight_edges": kinds.count(1)})


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
        hidden.append(_moved(network.hidden, -middle))
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


def _moved(basis: Basis, way: float) -> Basis:
    """The splines of an input to which a number is added."""
    return Basis(basis.low + way, basis.high + way, basis.intervals)


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
