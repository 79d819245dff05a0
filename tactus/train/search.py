"""The search over hidden layers and restarts, and the choice of the network: docs/networks.md.

Each candidate goes through three steps: the optimiser on tanh; the optimiser on the hardware's
activation, where that is not tanh, so that the weights compensate for its error; and a shift of the
output biases by the mean bit-true error, which removes what truncation adds. With many rows or for
classes Levenberg-Marquardt solves its normal equations, which takes a tenth of the time.

On one machine a candidate depends only on the task, its hidden nodes and its number, so neither the
number of workers nor an interruption changes the result. Elsewhere the result may differ: on
another processor, BLAS or tanh may round the last bit in another way, and for SCG on some ten
thousand rows another number of threads has the same effect.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.trained.dense import Dense, DenseNetwork, mlp_of, network_of, packed, tanh, unpacked
from golden.trained.function import Function, by_name, functions_of
from tactus.scene import Scene
from tactus.scene.scale import Scale, on_readings, on_signals, signals
from tactus.train.few_digits import with_few_digits
from tactus.train.objective import OPTIMISERS, Objective, normal_equations
from tactus.train.task import Frames, Task, as_read, bit_true_error, shift_biases, task_for

# With more recorded rows than this there are many: candidates are compared on a part of them.
MANY_ROWS = 5000


@dataclass(frozen=True)
class Result:
    """The result of one candidate.

    layers, restart: The hidden nodes of each layer and the number of the start, which identify the
        candidate.
    validation, test: Root mean square of the bit-true errors in percent, under the scene's
        disturbance; infinite for a refused candidate.
    refused: Why the candidate does not fit in the hardware's formats; empty if it does.
    """

    layers: tuple[int, ...]
    restart: int
    validation: float = float("inf")
    test: float = float("inf")
    refused: str = ""

    @property
    def rank(self) -> tuple[float, int, int]:
        """The least is best; equal errors go to the smaller network, then the earlier start."""
        return self.validation, sum(self.layers), self.restart


def has_many_rows(scene: Scene) -> bool:
    """Whether a scene has too many rows to train every candidate on all of them."""
    return len(scene.vectors().codes) > MANY_ROWS


def has_layers(scene: Scene) -> bool:
    """Whether the networks of a scene may be others than one hidden layer of tanh for numbers."""
    return bool(scene.labels or scene.members[0].layers or scene.training.layers)


def starting_weights(shape: tuple[int, int, int], rng: np.random.Generator) -> DenseNetwork:
    """Random weights with which every hidden node works in the curved part of tanh."""
    inputs, hidden, outputs = shape
    return mlp_of(
        rng.normal(0, 0.7, (hidden, inputs)),
        rng.normal(0, 0.7, hidden),
        rng.normal(0, 0.2, (outputs, hidden)),
        rng.normal(0, 0.2, outputs),
    )


def random_layers(
    shape: Sequence[int],
    activations: Sequence[str],
    rng: np.random.Generator,
    functions: Mapping[str, Function] | None = None,
) -> DenseNetwork:
    """A network with random weights, such that values have about the same size in every layer.

    ``functions`` are those that activations name.
    """
    layers = []
    for (inputs, nodes), kind in zip(pairwise(shape), (*activations, "linear"), strict=True):
        # A ReLU passes on half of the values.
        gain = 2.0 if "relu" in kind else 1.0
        weights = rng.normal(0, np.sqrt(gain / inputs), (nodes, inputs))
        tables = functions_of(kind, nodes, functions or {})
        layers.append(Dense(weights, rng.normal(0, 0.1, nodes), kind, functions=tables))
    return network_of(layers)


def descended(task: Task, start: Any, training: Frames, validation: Frames) -> Any:
    """The network to which the descents lead from ``start``, with its output biases shifted.

    If the scene has classes, its outputs are logits, which nothing shifts.
    """
    scene, settings = task.scene, task.scene.training
    normal, plain = task.normal, [Scale()] * start.shape[-1]
    like = on_signals(start, normal, plain)
    rows, held_back = (
        replace(part, inputs=signals(part.inputs, normal)) for part in (training, validation)
    )
    optimise: Any = OPTIMISERS[settings.optimiser]
    if (scene.labels or has_many_rows(scene)) and settings.optimiser == "levenberg-marquardt":
        optimise = normal_equations
    alone = scene.labels or (has_layers(scene) and not has_many_rows(scene))
    point = packed(like)
    for activation in dict.fromkeys((tanh,) if alone else (tanh, scene.scheme.real)):
        watched = like, rows, held_back, settings.patience
        aim = Objective(*watched, activation, settings.weight_decay)
        point = aim.search(optimise, point, settings.steps)
    network = on_readings(unpacked(point, like), normal, plain)
    return network if scene.labels else shift_biases(task, network, training)


def widths(low: int, high: int) -> list[int]:
    """The numbers of nodes that a search tries: from low to high, each about half as much again."""
    found = [low]
    while found[-1] < high:
        found.append(min(high, found[-1] + max(1, found[-1] // 2)))
    return found


def layers_searched(scene: Scene, number: int = 0) -> list[tuple[int, ...]]:
    """The hidden layers of every candidate: those that the scene names, or all of the search."""
    settings, member = scene.training, scene.members[number]
    named = member.layers or ((member.hidden,) if member.hidden else ())
    if named or (scene.labels and not settings.layers):
        return [named]
    least, most = settings.hidden
    low, high = settings.layers or (1, 1)
    sizes = widths(least, most) if settings.layers else range(least, most + 1)
    found = [(nodes,) * n for n in range(low, high + 1) for nodes in sizes]
    # Without a hidden layer there is one network, whatever the nodes would be.
    return list(dict.fromkeys(found))


def candidates(task: Task) -> list[tuple[tuple[int, ...], int]]:
    """The hidden layers and the number of the start of every candidate."""
    starts = range(task.scene.training.restarts)
    searched = layers_searched(task.scene, task.number)
    return [(layers, restart) for layers in searched for restart in starts]


def train(task: Task, layers: tuple[int, ...], restart: int) -> DenseNetwork:
    """The network of one candidate."""
    member, settings = task.scene.members[task.number], task.scene.training
    shape = (task.training.inputs.shape[1], *layers, task.training.targets.shape[1])
    rng = np.random.default_rng([settings.seed, task.number, *layers, restart])
    random: DenseNetwork
    if has_layers(task.scene) or has_many_rows(task.scene):
        kinds = member.activations or (settings.activation,) * len(layers)
        random = random_layers(shape, kinds, rng, by_name(member.functions))
    else:
        random = starting_weights(shape, rng)
    start = on_readings(random, task.normal, [Scale()] * shape[-1])
    return descended(task, start, task.training, task.validation)


def measure(task: Task, layers: tuple[int, ...], restart: int) -> Result:
    try:
        _, network = as_read(task, train(task, layers, restart))
        validation, test = (
            bit_true_error(task, network, part) for part in (task.validation, task.test)
        )
    except InputError as error:
        return Result(layers, restart, refused=str(error))
    return Result(layers, restart, validation, test)


@dataclass
class Stages:
    """The networks of a scene so far. Each of them sees the earlier ones of its own stage.

    chosen: Networks trained on the training rows, and chosen by the validation rows.
    tested: The same networks; with ``training.refit`` they are trained further on training and
        validation rows, so that they contain nothing of the test rows.
    written: The same networks; with ``training.refit`` they are trained further on all rows. They
        are as they will be read from their files.
    files: The written networks as their files hold them.
    full: With ``training.digits``: for each network its three stages before digits were removed.
    """

    scene: Scene
    chosen: list[DenseNetwork] = field(default_factory=list)
    tested: list[DenseNetwork] = field(default_factory=list)
    written: list[DenseNetwork] = field(default_factory=list)
    files: list[DenseNetwork] = field(default_factory=list)
    full: list[dict[str, DenseNetwork]] = field(default_factory=list)

    def task(self, earlier: list[DenseNetwork], number: int) -> Task:
        """The task of a network that follows the earlier ones of a stage."""
        return task_for(self.scene, self.scene.vectors(), earlier[:number])

    def add(self, *candidate: Any) -> None:
        """Train the next network from the candidate that was chosen for it."""
        stages: list[Any] = [self.chosen, self.tested, self.written]
        tasks = [self.task(networks, len(self.chosen)) for networks in stages]
        made = [as_read(tasks[0], network) for network in self.trained(tasks, *candidate)]
        for networks, (_, read) in zip(stages, made, strict=True):
            networks.append(read)
        self.files.append(made[-1][0])

    def trained(self, tasks: list[Task], *candidate: Any) -> list[Any]:
        """The chosen, the tested and the written network, each with its own task."""
        task, seen_more, seen_all = tasks
        found = [train(task, *candidate)] * 3
        if self.scene.training.refit:
            start = self._on_signals(found[0])
            found[1:] = (
                descended(seen, start, frames, frames)
                for seen, frames in ((seen_more, seen_more.known), (seen_all, seen_all.every))
            )
        if self.scene.training.digits:
            read = [as_read(task, network)[1] for network in found]
            self.full.append(dict(zip(("chosen", "tested", "written"), read, strict=True)))
            layered = has_layers(self.scene) or has_many_rows(self.scene)
            signals = [self._on_signals(network) for network in found]
            found = with_few_digits(list(zip(tasks, signals, strict=True)), layered)
        return found

    def _on_signals(self, network: DenseNetwork) -> DenseNetwork:
        """A network as its file gives it to training: logits have no scale."""
        scales = self.scene.scales_of(len(self.chosen))
        return on_signals(on_readings(network, *scales), *scales)
