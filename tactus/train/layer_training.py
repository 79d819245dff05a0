"""Trains networks of several layers, or with an activation other than tanh.

The training is that of one hidden layer of tanh (``tactus.train``): each candidate is a descent
from random weights, the validation rows choose one of the candidates, and the output biases are
shifted by the mean bit-true error. The scene names the nodes of each layer, or it asks for a search
with ``training.layers``. The search tries every number of layers, with some numbers of nodes
(``widths``), which all hidden layers of a candidate share.

With many rows, networks of one hidden layer of tanh are trained here too, of every number of nodes,
and Levenberg-Marquardt solves its normal equations, which takes a tenth of the time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.trained.dense import Dense, Trained, network_of, packed, unpacked
from golden.trained.function import Function, by_name, functions_of
from golden.trained.mlp import Activation, tanh
from tactus.scene import Scene
from tactus.scene.scale import Scale, on_readings, on_signals, signals
from tactus.train.descent.few_digits import FewDigits
from tactus.train.descent.objective import Rows
from tactus.train.descent.search import OPTIMISERS, Result, shift_biases
from tactus.train.descent.stages import Stages
from tactus.train.descent.task import Frames, Task
from tactus.train.layer_digits import ClassDigits, LayerDigits
from tactus.train.layer_objective import ClassObjective, LabelledRows, LayeredObjective, descend
from tactus.train.task_errors import as_read, bit_true_error

NORMAL_EQUATIONS: dict[str, Any] = OPTIMISERS | {"levenberg-marquardt": descend}
# With more recorded rows than this there are many: candidates are compared on a part of them.
MANY_ROWS = 5000


@dataclass(frozen=True)
class LayersResult(Result):
    """The result of one candidate with the nodes of each hidden layer.

    point: With many rows, all weights and biases, with which the search goes on.
    """

    layers: tuple[int, ...] = ()
    point: tuple[float, ...] = ()

    @property
    def candidate(self) -> tuple[Any, ...]:
        return self.layers, self.restart, self.point


def has_many_rows(scene: Scene) -> bool:
    """Whether a scene has too many rows to train every candidate on all of them."""
    return len(scene.vectors().codes) > MANY_ROWS


def random_layers(
    shape: Sequence[int],
    activations: Sequence[str],
    rng: np.random.Generator,
    functions: Mapping[str, Function] | None = None,
) -> Trained:
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


def descended(task: Task, start: Trained, training: Frames, validation: Frames) -> Trained:
    """The network to which a descent from ``start`` leads.

    Its output biases are shifted. If the scene has classes, its outputs are logits, which nothing
    shifts.
    """
    settings = task.scene.training
    outputs = start.shape[-1]
    normal, plain = task.normal, [Scale()] * outputs
    normalised: list[Rows] = [
        replace(f, inputs=signals(f.inputs, normal)) for f in (training, validation)
    ]
    like = on_signals(start, normal, plain)
    point = packed(like)
    objective_of: type[LayeredObjective] = LayeredObjective
    optimisers: dict[str, Any] = OPTIMISERS
    activations: list[Activation] = [tanh]
    if task.scene.labels:
        objective_of, optimisers = ClassObjective, NORMAL_EQUATIONS
        normalised = [LabelledRows(f.inputs, f.targets, f.scale) for f in normalised]
    elif has_many_rows(task.scene):
        optimisers = NORMAL_EQUATIONS
        activations.append(task.scene.scheme.real)
    limits = {"weight_decay": settings.weight_decay, "patience": settings.patience}
    for activation in dict.fromkeys(activations):
        objective = objective_of(like, training=normalised[0], validation=normalised[1], **limits)
        objective.activation = activation
        point = objective.search(optimisers[settings.optimiser], point, settings.steps)
    network = on_readings(unpacked(point, like), normal, plain)
    return network if task.scene.labels else shift_biases(task, network, training)


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


def started(
    task: Task, hidden: tuple[int, ...], restart: int, point: Sequence[float] = ()
) -> Trained:
    """The network from which a candidate goes on: a random one, or the one at ``point``.

    hidden: The nodes of its hidden layers.
    """
    member = task.scene.members[task.number]
    shape = (task.training.inputs.shape[1], *hidden, task.training.targets.shape[1])
    settings = task.scene.training
    kinds = member.activations or (settings.activation,) * len(hidden)
    rng = np.random.default_rng([settings.seed, task.number, *hidden, restart])
    random = random_layers(shape, kinds, rng, by_name(member.functions))
    if point:
        return unpacked(np.array(point), random)
    return on_readings(random, task.normal, [Scale()] * shape[-1])


def train(task: Task, *candidate: Any) -> Trained:
    """The network of one candidate; see ``started``."""
    return descended(task, started(task, *candidate), task.training, task.validation)


def measure(
    task: Task, hidden: tuple[int, ...], restart: int, point: Sequence[float] = ()
) -> LayersResult:
    """Train one candidate and measure its bit-true errors."""
    try:
        found = train(task, hidden, restart, point)
        network = as_read(task, found)[1]
        validation, test = (
            bit_true_error(task, network, part) for part in (task.validation, task.test)
        )
        reached = tuple(packed(found).tolist()) if has_many_rows(task.scene) else ()
        return LayersResult(sum(hidden), restart, validation, test, "", hidden, reached)
    except InputError as error:
        infinite = float("inf")
        return LayersResult(sum(hidden), restart, infinite, infinite, str(error), hidden)


class LayerStages(Stages):
    """The stages in which training makes a scene's networks of layers."""

    def trained(self, task: Task, *candidate: Any) -> Any:
        """The network of a candidate, which is trained unless its point is known."""
        return (started if candidate[2:] and candidate[2] else train)(task, *candidate)

    def refitted(self, task: Task, start: Any, frames: Frames) -> Any:
        """See ``Stages``."""
        return descended(task, start, frames, frames)

    @property
    def digits(self) -> type[FewDigits]:
        """See ``Stages``."""
        return ClassDigits if self.scene.labels else LayerDigits
