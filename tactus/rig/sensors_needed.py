"""Finds how much each sensor tells about each output, by training without it.

A sensor that is left out is not set to 0. Instead new networks are trained for the others, since
these often carry the same information. Errors are those on rows that took no part in the training;
see ``tactus.train.descent.split``. The networks are in floating point with tanh, and read only
sensors.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.mlp import tanh
from tactus.scene import Scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.scale import Scale, range_scale, readings, signals
from tactus.train.descent.objective import Objective, Rows, pack, unpack
from tactus.train.descent.search import OPTIMISERS, starting_weights
from tactus.train.descent.split import Split, split_of
from tactus.train.descent.task import LEAST_ROWS


@dataclass(frozen=True)
class Recording:
    """The readings of the sensors and the outputs that belong to them.

    readings, shape (rows, columns): The readings in the unit of the sensors.
    targets, scale, shape (rows, outputs): The outputs, and the divisors of their errors.
    sensors: The sensor of each column; a sensor whose past is used has several columns.
    """

    readings: Real
    targets: Real
    scale: Real
    sensors: tuple[str, ...]
    outputs: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """All sensors, each of them once, in the order of the columns."""
        return tuple(dict.fromkeys(self.sensors))

    def columns(self, kept: Sequence[str]) -> NDArray[np.int64]:
        """The columns of some sensors."""
        unknown = [name for name in kept if name not in self.sensors]
        if unknown or not kept:
            raise InputError(
                f"kept: got {', '.join(unknown) or 'no sensor'}, expected some of "
                f"{', '.join(self.names)}"
            )
        return np.flatnonzero(np.isin(self.sensors, kept))


@dataclass(frozen=True)
class Effort:
    """The settings with which networks are trained.

    hidden: Number of hidden nodes of each network.
    starts: Number of networks, of which the validation rows choose one.
    together: Whether one network has all outputs; otherwise each output has its own network.
    disturbance: The expected disturbance of the readings, in every part of the rows.
    optimiser, steps, patience, weight_decay: As in ``tactus.scene.training.Training``.
    """

    hidden: int = 8
    starts: int = 3
    together: bool = False
    disturbance: Disturbance = field(default_factory=Disturbance)
    optimiser: str = "levenberg-marquardt"
    steps: int = 300
    patience: int = 50
    weight_decay: float = 1e-6


@dataclass(frozen=True)
class Errors:
    """Errors of trained networks, in percent of the scale, shape (splits, outputs).

    validation: Root mean squares on the rows that chose among the starts. They decide what is left
        out.
    rms, mean: Root mean squares and mean magnitudes on the test rows, which decided nothing.
    """

    validation: Real
    rms: Real
    mean: Real


@dataclass(frozen=True)
class Removal:
    """A step with one sensor less.

    dropped: Name of the sensor that was left out; empty in the first step, which has all sensors.
    """

    dropped: str
    kept: tuple[str, ...]
    errors: Errors


def recording_of(scene: Scene) -> Recording:
    """The recording of a scene, as the scene's own training reads it."""
    vectors = scene.vectors()
    return Recording(
        readings(vectors.inputs, scene.scales(scene.inputs)),
        vectors.targets,
        vectors.scale,
        tuple(scene.sensors[tap.sensor] for tap in scene.window.taps),
        scene.outputs,
    )


def splits_of(scene: Scene, seeds: Sequence[int]) -> list[Split]:
    """The split that ``training.split`` of a scene requests, for each of several seeds."""
    return [split_of(replace(scene, training=replace(scene.training, seed=seed))) for seed in seeds]


def held_out(
    recording: Recording,
    splits: Sequence[Split],
    kept: Sequence[str],
    effort: Effort,
    seed: int = 1,
) -> Errors:
    """Errors of networks that read only some of the sensors.

    splits: The splits; networks are trained anew for each.
    kept: The sensors that the networks read.
    seed: Seed of starting weights and disturbance. The same seed, splits and sensors give the same
        result on one machine, with any number of cores.
    """
    columns = recording.columns(kept)
    outputs = range(len(recording.outputs))
    groups = [list(outputs)] if effort.together else [[output] for output in outputs]
    jobs = [
        delayed(_best)(recording, split, columns, group, effort, [seed, number])
        for number, split in enumerate(splits)
        for group in groups
    ]
    found = Parallel(n_jobs=-1)(jobs)
    parts = np.array([np.concatenate(part, axis=1) for part in _chunks(found, len(groups))])
    return Errors(parts[:, 0], parts[:, 1], parts[:, 2])


def without_each(
    recording: Recording, splits: Sequence[Split], effort: Effort, seed: int = 1
) -> list[Removal]:
    """Errors with all sensors, and then without each one of them; see ``held_out``."""
    names = recording.names
    steps = [Removal("", names, held_out(recording, splits, names, effort, seed))]
    if len(names) > 1:
        steps += [_without(recording, splits, names, name, effort, seed) for name in names]
    return steps


def one_after_another(
    recording: Recording,
    splits: Sequence[Split],
    effort: Effort,
    seed: int = 1,
    known: Sequence[Removal] = (),
) -> list[Removal]:
    """Leave out one sensor after another, each time that with which the worst output loses least.

    The validation rows decide what is left out, by the mean over the splits.

    recording, splits, effort, seed: See ``held_out``.
    known: Results of ``without_each`` for the same arguments, which are then not computed again.
    """
    found = {step.kept: step for step in known}
    names = recording.names
    first = found.get(names) or Removal("", names, held_out(recording, splits, names, effort, seed))
    steps = [first]
    while len(steps[-1].kept) > 1:
        kept = steps[-1].kept
        tried = [
            found.get(tuple(other for other in kept if other != name))
            or _without(recording, splits, kept, name, effort, seed)
            for name in kept
        ]
        steps.append(min(tried, key=lambda step: step.errors.validation.mean(axis=0).max()))
    return steps


def _without(
    recording: Recording,
    splits: Sequence[Split],
    names: Sequence[str],
    name: str,
    effort: Effort,
    seed: int,
) -> Removal:
    kept = tuple(other for other in names if other != name)
    return Removal(name, kept, held_out(recording, splits, kept, effort, seed))


def _chunks(found: list[Real], size: int) -> Iterator[list[Real]]:
    for at in range(0, len(found), size):
        yield found[at : at + size]


def _best(
    recording: Recording,
    split: Split,
    columns: NDArray[np.int64],
    group: list[int],
    effort: Effort,
    seed: list[int],
) -> Real:
    """Errors of the network that the validation rows choose, shape (3, outputs of the group)."""
    training, validation, test = (
        _rows(recording, part, rows, columns, group, effort.disturbance, seed)
        for part, rows in vars(split).items()
    )
    scales = [range_scale(column) if np.ptp(column) else Scale() for column in training.inputs.T]
    training, validation, test = (
        replace(part, inputs=signals(part.inputs, scales)) for part in (training, validation, test)
    )
    shape = (len(columns), effort.hidden, len(group))
    found = []
    for start in range(effort.starts):
        rng = np.random.default_rng([*seed, *group, effort.hidden, start])
        aim = Objective(shape, tanh, training, validation, effort.weight_decay, effort.patience)
        point = pack(starting_weights(shape, rng))
        mlp = unpack(aim.search(OPTIMISERS[effort.optimiser], point, effort.steps), shape)
        misses = [
            100 * part.residuals(mlp, tanh).reshape(part.targets.shape)
            for part in (validation, test)
        ]
        rms = [np.sqrt((miss**2).mean(axis=0)) for miss in misses]
        found.append(np.array([*rms, np.abs(misses[1]).mean(axis=0)]))
    return min(found, key=lambda errors: float((errors[0] ** 2).sum()))


def _rows(
    recording: Recording,
    part: str,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    group: list[int],
    disturbance: Disturbance,
    seed: list[int],
) -> Rows:
    """A part of the rows, repeated as the disturbance requires; the same rows for any sensors."""
    if disturbance.none:
        found = recording.readings[rows]
    else:
        rows = np.tile(rows, -(-LEAST_ROWS[part] // len(rows)))
        rng = np.random.default_rng([*seed, list(LEAST_ROWS).index(part)])
        which = [recording.names.index(name) for name in recording.sensors]
        found = np.concatenate(
            [disturbance.of(recording.readings[[row]], rng, which) for row in rows]
        )
    targets, scale = recording.targets[rows], recording.scale[rows]
    return Rows(found[:, columns], targets[:, group], scale[:, group])
