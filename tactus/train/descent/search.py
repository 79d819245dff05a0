"""The search over hidden nodes and restarts, and the choice of the network.

Each candidate goes through three steps: the optimiser on tanh; the optimiser on the hardware's
activation, where that is not tanh, so that the weights compensate for its error; and a shift of the
output biases by the mean bit-true error, which removes what truncation adds. The candidate with the
least bit-true error on the validation rows is kept. Where the scene declares noise or drift of its
sensors, all of this is done on disturbed rows, which are the same for every candidate.

The chosen network may be trained further, from its present weights, on more rows:
``training.refit``. With training and validation rows alone, the test rows tell its error. With all
rows, it is the network that is written.

On one machine a candidate depends only on the task, its hidden nodes and its number, so neither the
number of workers nor an interruption changes the result. Elsewhere the result may differ: on
another processor, BLAS or tanh may round the last bit in another way, and for SCG on some ten
thousand rows another number of threads has the same effect.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.dense import Some, Trained, layers_of, rebuilt
from golden.trained.mlp import Mlp, tanh
from tactus.scene.scale import Scale, on_readings, on_signals, signals
from tactus.train.descent import levenberg_marquardt, scg
from tactus.train.descent.objective import Objective, pack, unpack
from tactus.train.descent.task import Frames, Task

OPTIMISERS = {"levenberg-marquardt": levenberg_marquardt.descend, "scg": scg.descend}


@dataclass(frozen=True)
class Result:
    """The result of one candidate.

    hidden, restart: The hidden nodes and the number of the start, which identify the candidate.
    validation, test: Root mean square of the bit-true errors in percent, under the scene's
        disturbance; infinite for a refused candidate.
    refused: Why the candidate does not fit in the hardware's formats; empty if it does.
    """

    hidden: int
    restart: int
    validation: float
    test: float
    refused: str = ""

    @property
    def candidate(self) -> tuple[Any, ...]:
        """What a training of it gets beside the task."""
        return self.hidden, self.restart

    @property
    def rank(self) -> tuple[float, int, int]:
        """The least is best; equal errors go to the smaller network, then the earlier start."""
        return self.validation, self.hidden, self.restart


def starting_weights(shape: tuple[int, int, int], rng: np.random.Generator) -> Mlp:
    """Random weights with which every hidden node works in the curved part of tanh."""
    inputs, hidden, outputs = shape
    return Mlp(
        rng.normal(0, 0.7, (hidden, inputs)),
        rng.normal(0, 0.7, hidden),
        rng.normal(0, 0.2, (outputs, hidden)),
        rng.normal(0, 0.2, outputs),
    )


def shift_biases(task: Task, network: Some, frames: Frames) -> Some:
    """Shift the output biases by the weighted mean bit-true error on ``frames``, twice."""
    weight = 1 / frames.scale**2
    for _ in range(2):
        results = task.bit_true(network, frames)
        miss = (weight * (frames.targets - results)).sum(axis=0) / weight.sum(axis=0)
        *before, last = layers_of(network)
        network = rebuilt(network, [*before, replace(last, biases=last.biases + miss)])
    return network


def train(
    task: Task, hidden: int, restart: int, objective: Callable[..., Objective] = Objective
) -> Mlp:
    """Train the network of one candidate.

    objective: Makes the objective of each descent; another one than the default can watch the
        progress.
    """
    shape = (task.training.inputs.shape[1], hidden, task.training.targets.shape[1])
    rng = np.random.default_rng([task.scene.training.seed, task.number, hidden, restart])
    start = on_readings(starting_weights(shape, rng), task.normal, [Scale()] * shape[2])
    return descended(task, start, task.training, task.validation, objective)


def refitted(task: Task, mlp: Mlp, frames: Frames) -> Mlp:
    """Train a network further, from its present weights, on more rows; nothing ends it early."""
    return descended(task, mlp, frames, frames)


def descended(
    task: Task,
    start: Mlp,
    training: Frames,
    validation: Frames,
    objective: Callable[..., Objective] = Objective,
) -> Mlp:
    """The network that the descents reach from ``start``, on tanh and the scene's activation."""
    settings = task.scene.training
    normal, plain = task.normal, [Scale()] * len(start.b2)
    normalised = [replace(f, inputs=signals(f.inputs, normal)) for f in (training, validation)]
    shape, point = start.shape, pack(on_signals(start, normal, plain))
    descend = OPTIMISERS[settings.optimiser]
    for activation in dict.fromkeys((tanh, task.scene.scheme.real)):
        aim = objective(shape, activation, *normalised, settings.weight_decay, settings.patience)
        point = aim.search(descend, point, settings.steps)
    mlp = on_readings(unpack(point, shape), normal, plain)
    return shift_biases(task, mlp, training)


def measure(task: Task, hidden: int, restart: int) -> Result:
    """Train one candidate and measure its bit-true errors."""
    try:
        validation, test = bit_true_errors(task, train(task, hidden, restart))
    except InputError as error:
        return Result(hidden, restart, float("inf"), float("inf"), str(error))
    return Result(hidden, restart, validation, test)


def bit_true_errors(task: Task, network: Trained) -> tuple[float, float]:
    """The bit-true errors of the validation and of the test rows, under the scene's disturbance."""
    return bit_true_error(task, network, task.validation), bit_true_error(task, network, task.test)


def bit_true_error(task: Task, network: Trained, frames: Frames) -> float:
    """Root mean square of the bit-true percent errors on some frames of a task."""
    return float(np.sqrt((signed_errors(task, network, frames) ** 2).mean()))


def signed_errors(task: Task, network: Trained, frames: Frames) -> Real:
    """Bit-true errors in percent, with their signs, shape (rows, outputs)."""
    return 100 * (task.bit_true(network, frames) - frames.targets) / frames.scale


def candidates(task: Task) -> list[tuple[int, int]]:
    """Hidden nodes and start number of every candidate, the smallest networks first."""
    settings = task.scene.training
    hidden = task.scene.members[task.number].hidden
    low, high = (hidden, hidden) if hidden else settings.hidden
    return [(h, r) for h in range(low, high + 1) for r in range(settings.restarts)]
