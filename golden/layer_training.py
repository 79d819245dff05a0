"""Trains networks for which the scene names several layers, or an activation other than tanh.

The training is that of one hidden layer of tanh (``golden.training``): each restart is a descent
from random weights, the validation rows choose one of the restarts, and the output biases are
shifted by the mean bit-true error. The scene names the nodes, so nothing else is searched.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from golden import class_descent
from golden.dense import Dense, Trained, network_of
from golden.function import Function, by_name, functions_of
from golden.input_error import InputError
from golden.layer_objective import ClassObjective, LabelledRows, LayeredObjective, packed, unpacked
from golden.real import Real
from golden.scene import Scene
from golden.scene.labels import wrong_percent
from golden.scene.scale import Scale, on_readings, on_signals, signals
from golden.training.objective import Rows
from golden.training.search import OPTIMISERS, Result, shift_biases, signed_errors
from golden.training.task import Frames, Task, task_for

CLASS_OPTIMISERS: dict[str, Any] = OPTIMISERS | {"levenberg-marquardt": class_descent.descend}


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

    Raises
    ------
    InputError
        When the hardware's formats cannot hold its weights.
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
    if task.scene.labels:
        objective_of, optimisers = ClassObjective, CLASS_OPTIMISERS
        normalised = [LabelledRows(f.inputs, f.targets, f.scale) for f in normalised]
    objective = objective_of(
        like,
        training=normalised[0],
        validation=normalised[1],
        weight_decay=settings.weight_decay,
        patience=settings.patience,
    )
    point = objective.search(optimisers[settings.optimiser], point, settings.steps)
    network = on_readings(unpacked(point, like), normal, plain)
    return network if task.scene.labels else shift_biases(task, network, training)


def as_read(task: Task, network: Trained) -> tuple[Trained, Trained]:
    """A trained network as a file holds it, and as it is read from there."""
    scene = task.scene
    inputs, outputs = scene.scales_of(task.number)
    file = on_readings(network, inputs, outputs)
    return file, on_signals(file, *scene.scales_as_read(file, task.number))


def percent_errors(task: Task, network: Trained, frames: Frames) -> Real:
    """Bit-true errors in percent, shape (rows, outputs).

    They have their signs or, of a class, are those of ``wrong_percent``.
    """
    if task.scene.labels:
        return wrong_percent(task.bit_true(network, frames), frames.targets)
    return signed_errors(task, network, frames)


def bit_true_error(task: Task, network: Trained, frames: Frames) -> float:
    """The figure that chooses among restarts: the root mean square of the bit-true errors.

    If the scene has classes, it is the part of the frames with a wrong decision, in percent.
    """
    errors = percent_errors(task, network, frames)
    if task.scene.labels:
        return float(errors.max(axis=1).mean())
    return float(np.sqrt((errors**2).mean()))


def train(task: Task, restart: int) -> Trained:
    """The network of one restart.

    Raises
    ------
    InputError
        When the hardware's formats cannot hold its weights.
    """
    member = task.scene.members[task.number]
    shape = (task.training.inputs.shape[1], *member.layers, task.training.targets.shape[1])
    kinds = member.activations or ("tanh",) * len(member.layers)
    rng = np.random.default_rng([task.scene.training.seed, task.number, *member.layers, restart])
    random = random_layers(shape, kinds, rng, by_name(member.functions))
    start = on_readings(random, task.normal, [Scale()] * shape[-1])
    return descended(task, start, task.training, task.validation)


def measured(task: Task, restart: int) -> Result:
    """Train one candidate and measure its bit-true errors."""
    nodes = sum(task.scene.members[task.number].layers)
    try:
        network = as_read(task, train(task, restart))[1]
        validation = bit_true_error(task, network, task.validation)
        test = bit_true_error(task, network, task.test)
    except InputError as error:
        return Result(nodes, restart, float("inf"), float("inf"), str(error))
    return Result(nodes, restart, validation, test)


def search(task: Task, workers: int = -1) -> Iterator[Result]:
    """The results of all restarts, in order, each as soon as it is known."""
    jobs = (delayed(measured)(task, restart) for restart in range(task.scene.training.restarts))
    yield from Parallel(n_jobs=workers, return_as="generator")(jobs)


@dataclass
class LayerStages:
    """The stages in which training makes a scene's network; see ``golden.training.stages``."""

    scene: Scene
    chosen: list[Trained] = field(default_factory=list)
    tested: list[Trained] = field(default_factory=list)
    written: list[Trained] = field(default_factory=list)
    files: list[Trained] = field(default_factory=list)

    def task(self, earlier: list[Trained], number: int) -> Task:
        """The task of the only network."""
        return task_for(self.scene, self.scene.vectors(), [])

    def add(self, hidden: int, restart: int) -> None:
        """Add the network of the chosen restart; ``hidden`` is the number of all of its nodes.

        Raises
        ------
        InputError
            When the hardware's formats cannot hold its weights.
        """
        task = self.task([], 0)
        chosen = as_read(task, train(task, restart))
        tested = written = chosen
        if self.scene.training.refit:
            start = on_signals(chosen[0], *self.scene.scales_of(0))
            tested = as_read(task, descended(task, start, task.known, task.known))
            written = as_read(task, descended(task, start, task.every, task.every))
        self.chosen.append(chosen[1])
        self.tested.append(tested[1])
        self.written.append(written[1])
        self.files.append(written[0])
