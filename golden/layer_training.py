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

from golden.dense import Dense, Trained, layers_of, network_of
from golden.function import Function, by_name, functions_of
from golden.input_error import InputError
from golden.mlp import tanh
from golden.real import Real
from golden.scene import Scene
from golden.scene.scale import Scale, on_readings, on_signals, signals
from golden.training.objective import Objective
from golden.training.search import OPTIMISERS, Result, bit_true_errors, shift_biases
from golden.training.task import Frames, Task, task_for


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


def packed(network: Trained) -> Real:
    """All weights and biases in one vector, layer by layer."""
    parts = [p for layer in layers_of(network) for p in (layer.weights.ravel(), layer.biases)]
    return np.concatenate(parts)


def unpacked(vector: Real, like: Trained) -> Trained:
    """The inverse of ``packed`` for a network with the layers of ``like``."""
    layers, at = [], 0
    for layer in layers_of(like):
        end = at + layer.weights.size
        weights = vector[at:end].reshape(layer.weights.shape)
        at = end + layer.nodes
        layers.append(replace(layer, weights=weights, biases=vector[end:at]))
    return network_of(layers)


class LayeredObjective(Objective):
    """The function that a descent minimises; see ``Objective``.

    Parameters
    ----------
    like : Mlp or DenseNetwork
        A network with the layers that are trained.
    **settings
        The parameters of ``Objective``, except the shape and the activation.
    """

    def __init__(self, like: Trained, **settings: Any):
        inputs, *hidden, outputs = like.shape
        super().__init__(shape=(inputs, sum(hidden), outputs), activation=tanh, **settings)
        self.like = like

    def network(self, vector: Real) -> Trained:
        return unpacked(vector, self.like)

    def jacobian(self, vector: Real) -> Real:
        network = self.network(vector)
        values, slopes = self._forward(network)
        scale = self.training.scale
        rows, outputs = scale.shape
        back = np.broadcast_to(np.eye(outputs), (rows, outputs, outputs))
        found: list[Real] = []
        for n, layer in reversed(list(enumerate(layers_of(network)))):
            back = back * slopes[n][:, np.newaxis, :]
            weights = back[..., np.newaxis] * values[n][:, np.newaxis, np.newaxis, :]
            found = [weights.reshape(rows, outputs, -1), back, *found]
            back = back @ layer.weights
        result = np.concatenate(found, axis=2) / scale[:, :, np.newaxis]
        decay = np.sqrt(self.weight_decay) * np.eye(len(vector))
        return np.concatenate([result.reshape(-1, len(vector)), decay])

    def evaluate(self, vector: Real) -> tuple[float, Real]:
        residuals = self.residuals(vector)
        network = self.network(vector)
        values, slopes = self._forward(network)
        scale = self.training.scale
        back = residuals[: scale.size].reshape(scale.shape) / scale
        found: list[Real] = []
        for n, layer in reversed(list(enumerate(layers_of(network)))):
            back = back * slopes[n]
            found = [(back.T @ values[n]).ravel(), back.sum(axis=0), *found]
            back = back @ layer.weights
        gradient = np.concatenate(found)
        return float(residuals @ residuals), 2 * (gradient + self.weight_decay * vector)

    def _forward(self, network: Trained) -> tuple[list[Real], list[Real]]:
        """The inputs of each layer, and the slopes of its activation."""
        values, slopes = [self.training.inputs], []
        for layer in layers_of(network):
            sums = values[-1] @ layer.weights.T + layer.biases
            value, slope = layer.activate(sums, self.activation)
            values.append(value)
            slopes.append(slope)
        return values, slopes


def descended(task: Task, start: Trained, training: Frames, validation: Frames) -> Trained:
    """The network to which a descent from ``start`` leads, with its output biases shifted.

    Raises
    ------
    InputError
        When the hardware's formats cannot hold its weights.
    """
    settings = task.scene.training
    outputs = start.shape[-1]
    normal, plain = task.normal, [Scale()] * outputs
    normalised = [replace(f, inputs=signals(f.inputs, normal)) for f in (training, validation)]
    like = on_signals(start, normal, plain)
    point = packed(like)
    objective = LayeredObjective(
        like,
        training=normalised[0],
        validation=normalised[1],
        weight_decay=settings.weight_decay,
        patience=settings.patience,
    )
    point = objective.search(OPTIMISERS[settings.optimiser], point, settings.steps)
    return shift_biases(task, on_readings(unpacked(point, like), normal, plain), training)


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
        validation, test = bit_true_errors(task, train(task, restart))
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
        chosen = self._as_read(train(task, restart))
        tested = written = chosen
        if self.scene.training.refit:
            tested = self._as_read(descended(task, chosen[1], task.known, task.known))
            written = self._as_read(descended(task, chosen[1], task.every, task.every))
        self.chosen.append(chosen[1])
        self.tested.append(tested[1])
        self.written.append(written[1])
        self.files.append(written[0])

    def _as_read(self, network: Trained) -> tuple[Trained, Trained]:
        """The network as a file holds it, and as it is read from there."""
        scales = self.scene.scales_of(0)
        file = on_readings(network, *scales)
        return file, on_signals(file, *scales)
