"""The data from which one network of a scene learns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.networks.arrangement import seen
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from tactus.scene import Scene, Vectors
from tactus.scene.labels import wrong_percent
from tactus.scene.scale import Scale, on_readings, on_signals, range_scale, readings
from tactus.train.objective import Rows
from tactus.train.split import Split, split_of

# The parts of the rows, each of which is disturbed with its own random numbers. The first three are
# the split.
PARTS = ("training", "validation", "test", "known", "every")

# A disturbed part of the rows is repeated until it has at least so many rows. With fewer, chance
# decides which network looks best; more would make training slow.
TRAINED_ROWS = 300
MEASURED_ROWS = 600
# This is for a single descent that nothing ends early: only the random draws prevent it from
# learning the disturbance.
REFITTED_ROWS = 600
LEAST_ROWS = {"training": TRAINED_ROWS, "validation": MEASURED_ROWS, "test": MEASURED_ROWS}


@dataclass(frozen=True)
class Frames(Rows):
    """Rows as the sensors give them.

    inputs, shape (rows, inputs): The inputs in training: the quantised samples and, in a cascade,
        the outputs of earlier networks, bit-true or in floating point according to
        ``training.earlier_outputs``.
    codes, shape (rows, inputs): The inputs of the hardware.
    """

    codes: Codes

    def take(self, rows: NDArray[np.int64]) -> Frames:
        names = "inputs", "targets", "scale", "codes"
        return replace(self, **{name: getattr(self, name)[rows] for name in names})


@dataclass(frozen=True)
class Task:
    """The training of one network, with its inputs and targets.

    number: Index of the network in the scene.
    recorded: All rows as they were recorded.
    training, validation, test: The parts of the split under ``training.noise`` and
        ``training.drift``; without these, as recorded. They are the same for every candidate.
    known, every: Training and validation rows together, and all rows, under the same disturbance.
    """

    scene: Scene
    number: int
    split: Split
    recorded: Frames
    training: Frames
    validation: Frames
    test: Frames
    known: Frames
    every: Frames

    @property
    def normal(self) -> list[Scale]:
        """The scale of each input during training.

        If ``data.scale`` names the column, it is the range of the training rows, whatever the range
        of the converter is. Weights start in proportion to it and are kept small in proportion to
        it. The scale is folded into the weights. Other columns are used without a scale.
        """
        columns = self.scene.columns_of(self.number)
        return [
            range_scale(inputs)
            if self.scene.column(name) in self.scene.known_scales and np.ptp(inputs)
            else Scale()
            for name, inputs in zip(columns, self.training.inputs.T, strict=False)
        ]

    def rows(self, part: str) -> NDArray[np.int64]:
        """The numbers of the recorded rows in one of ``PARTS``."""
        return self.split.rows(part, len(self.recorded.codes))

    def bit_true(self, network: DenseNetwork, frames: Frames) -> Real:
        """Outputs of a network in the scene's hardware."""
        return SIGNAL.to_real(self.scene.build(network).process(frames.codes))


def task_for(scene: Scene, vectors: Vectors, earlier: Sequence[DenseNetwork]) -> Task:
    """The task of the network that follows ``earlier``, the networks trained before it."""
    split = split_of(scene)
    number = len(earlier)
    outputs = scene.members[number].outputs
    columns = [scene.outputs.index(name) for name in outputs]
    targets = vectors.targets[:, columns]
    scale = vectors.scale[:, columns]

    recorded_readings = readings(vectors.inputs, scene.scales(scene.inputs))
    sensors = [tap.sensor for tap in scene.window.taps]

    def frames(codes: Codes, rows: NDArray[np.int64]) -> Frames:
        found = _seen(scene, codes, earlier)
        return Frames(
            targets=targets[rows], scale=scale[rows], labelled=bool(scene.labels), **found
        )

    def disturbed(part: str) -> Frames:
        rows = split.rows(part, len(targets))
        disturbance = scene.training.disturbance
        if disturbance.none:
            return recorded.take(rows)
        rows = np.tile(rows, -(-LEAST_ROWS.get(part, REFITTED_ROWS) // len(rows)))
        rng = np.random.default_rng([scene.training.seed, PARTS.index(part)])
        # Each row has its own drift, because a few drifts with many rows each would be a chance
        # sample.
        disturbed = [disturbance.of(recorded_readings[[row]], rng, sensors) for row in rows]
        return frames(scene.codes_of(np.concatenate(disturbed)), rows)

    recorded = frames(vectors.codes, split.rows("every", len(targets)))
    return Task(scene, number, split, recorded, *(disturbed(part) for part in PARTS))


def _seen(scene: Scene, codes: Codes, earlier: Sequence[DenseNetwork]) -> dict[str, Any]:
    """The inputs of the network after ``earlier``, as numbers and as codes."""
    samples = SIGNAL.to_real(codes)
    bit_true: list[Codes] = []
    given: list[Real] = []
    for mlp in earlier:
        bit_true.append(scene.build(mlp).process(seen(scene.arrangement, codes, bit_true)))
        if scene.training.earlier_outputs == "float":
            real = seen(scene.arrangement, samples, given)
            given.append(mlp.process(real, scene.scheme.real))
        else:
            given.append(SIGNAL.to_real(bit_true[-1]))
    return {
        "inputs": seen(scene.arrangement, samples, given),
        "codes": seen(scene.arrangement, codes, bit_true),
    }


def shift_biases(task: Task, network: DenseNetwork, frames: Frames) -> DenseNetwork:
    """Shift the output biases by the weighted mean bit-true error on ``frames``, twice."""
    weight = 1 / frames.scale**2
    for _ in range(2):
        results = task.bit_true(network, frames)
        miss = (weight * (frames.targets - results)).sum(axis=0) / weight.sum(axis=0)
        *before, last = network.layers
        network = DenseNetwork((*before, replace(last, biases=last.biases + miss)))
    return network


def as_read(task: Task, network: DenseNetwork) -> tuple[DenseNetwork, DenseNetwork]:
    """A trained network as a file holds it, and as it is read from there."""
    scene = task.scene
    inputs, outputs = scene.scales_of(task.number)
    file = on_readings(network, inputs, outputs)
    return file, on_signals(file, *scene.scales_as_read(file, task.number))


def signed_errors(task: Task, network: DenseNetwork, frames: Frames) -> Real:
    """Bit-true errors in percent, with their signs, shape (rows, outputs)."""
    return 100 * (task.bit_true(network, frames) - frames.targets) / frames.scale


def percent_errors(task: Task, network: DenseNetwork, frames: Frames) -> Real:
    """Bit-true errors in percent, shape (rows, outputs).

    They have their signs or, of a class, are those of ``wrong_percent``.
    """
    if task.scene.labels:
        return wrong_percent(task.bit_true(network, frames), frames.targets)
    return signed_errors(task, network, frames)


def bit_true_error(task: Task, network: DenseNetwork, frames: Frames) -> float:
    """The figure that chooses among candidates: the root mean square of the bit-true errors.

    If the scene has classes, it is the part of the frames with a wrong decision, in percent.
    """
    errors = percent_errors(task, network, frames)
    if task.scene.labels:
        return float(errors.max(axis=1).mean())
    return float(np.sqrt((errors**2).mean()))
