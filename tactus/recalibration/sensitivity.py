"""How drifts and noise of the sensors become errors of the outputs, from a recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.table import read_csv_file, read_table
from tactus.scene import Scene, Vectors
from tactus.scene.disturbance import Disturbance, expected_drift, zero_signals
from tactus.scene.scale import Scale, signals

# An own error of a network below this, in percent, does not count.
LEAST_ERROR = 0.01

# How often the noise of a reading is drawn.
DRAWS = 50

# Number of recorded rows next to a placement from which the networks' own errors there are taken.
NEAREST = 3


def outputs_and_slopes(scene: Scene, samples: Real) -> tuple[Real, Real]:
    """Outputs of the networks in floating point, and their derivatives by the sensors.

    samples, shape (rows, sensors): The samples as signals.

    Returns: shape (rows, outputs); float array, shape (rows, outputs, sensors).
    """
    rows, sensors = samples.shape
    outputs, slopes = np.empty((rows, 0)), np.empty((rows, 0, sensors))
    by_sensor = np.broadcast_to(np.eye(sensors), (rows, sensors, sensors))
    cascade = scene.arrangement == "cascade"
    for mlp in scene.mlps():
        seen = np.hstack([samples, outputs]) if cascade else samples
        first, second = mlp.layers
        hidden, bends = scene.scheme.real(first.sums(seen))
        found = (second.weights * bends[:, np.newaxis]) @ first.weights
        inner = np.concatenate([by_sensor, slopes], axis=1) if cascade else by_sensor
        outputs = np.hstack([outputs, second.sums(hidden)])
        slopes = np.concatenate([slopes, found @ inner], axis=1)
    return outputs, slopes


@dataclass(frozen=True)
class Sensitivity:
    """How drifts of the sensors, and noise of readings, become errors of the outputs of a scene.

    A drift is described by ``theta``, shape (2 sensors,): first the correction of the gain of each
    sensor, and then that of each offset, in standard deviations of the expected drift. So before
    any reading ``theta`` has mean 0 and covariance ``I``.

    gain, offset, shape (sensors,): Standard deviations of the expected drift; the offset is a
        signal.
    noise, shape (sensors,): Standard deviation of one reading as a signal.
    """

    scene: Scene
    gain: Real
    offset: Real
    noise: Real

    @classmethod
    def of(cls, scene: Scene, noise: Real, drift: Disturbance | None = None) -> Sensitivity:
        """The sensitivity of a scene.

        drift: Gain and offset of the expected drift, in the unit of the readings, in the place of
            ``expected_drift``.
        """
        if drift is None:
            return cls(scene, *expected_drift(scene), noise)
        factors = np.array([s.factor for s in scene.scales(scene.sensors)])
        return cls(scene, np.full(len(factors), drift.gain), drift.offset / factors, noise)

    def moves(self, samples: Real) -> Real:
        """What each element of ``theta`` adds to samples, shape (rows, 2 sensors)."""
        by_gain = (samples + zero_signals(self.scene)) * self.gain
        return np.hstack([by_gain, np.broadcast_to(self.offset, by_gain.shape)])

    def moved(self, samples: Real, theta: Real) -> Real:
        by_gain, by_offset = np.split(self.moves(samples) * theta, 2, axis=1)
        return samples + by_gain + by_offset

    def drifted(self, samples: Real, theta: Real, least_gain: float) -> Real:
        """Samples that the correction turns into these, which the sensors would give now.

        least_gain: Lower limit for gains of the correction, whose inverse would have no limit.
        """
        found = self.correction(theta)
        return signals(samples, [replace(s, factor=max(s.factor, least_gain)) for s in found])

    def correction(self, theta: Real) -> list[Scale]:
        """The correction of each sensor: networks get ``offset + factor * signal``."""
        by_gain, by_offset = np.split(theta, 2)
        gains = by_gain * self.gain
        offsets = gains * zero_signals(self.scene) + by_offset * self.offset
        return [Scale(float(o), float(1 + g)) for o, g in zip(offsets, gains, strict=True)]

    def by_theta(self, slopes: Real, samples: Real) -> Real:
        """Turn derivatives by the sensors into derivatives by ``theta``."""
        result: Real = np.concatenate([slopes, slopes], axis=2)
        return result * self.moves(samples)[:, np.newaxis]

    @cached_property
    def own_errors(self) -> Real:
        """The networks' own errors, shape (recorded rows, outputs), in percent."""
        vectors = self.scene.vectors()
        return vectors.percent_errors(self.scene.process_real(vectors.inputs))

    @cached_property
    def error(self) -> Real:
        """The root mean square of the own errors, at least ``LEAST_ERROR``, shape (outputs,)."""
        return np.maximum(np.sqrt((self.own_errors**2).mean(axis=0)), LEAST_ERROR)

    @cached_property
    def recorded(self) -> Placements:
        """The rows of the recording as placements that were each read once."""
        vectors = self.scene.vectors()
        return Placements(
            vectors.inputs, vectors.targets, vectors.scale, np.ones(len(vectors.inputs))
        )

    @cached_property
    def tells(self) -> Real:
        """``telling`` of the recorded rows."""
        return self.telling(self.recorded)

    @cached_property
    def squares(self) -> Real:
        """``M`` of each output, shape (outputs, 2 sensors, 2 sensors).

        A correction that is off by ``theta`` adds ``theta^T M theta`` to the mean square of the
        output's error over the recording.
        """
        return np.asarray(
            np.einsum("roi,roj->oij", self.tells, self.tells, optimize=True) / len(self.tells)
        )

    def telling(self, placements: Placements) -> Real:
        """Derivatives by ``theta`` of the errors, in percent, (placements, outputs, 2 sensors)."""
        _, slopes = outputs_and_slopes(self.scene, placements.inputs)
        by_theta = self.by_theta(slopes, placements.inputs)
        return by_theta * (100 / placements.scale)[:, :, np.newaxis]

    def spread(self, placements: Placements) -> Real:
        """``S``, the covariance of the part of the placements' errors without drift, in percent.

        It has two parts: the networks' own errors, and the effect of the readings' noise on the
        outputs. The noise is drawn around the reading, and around the reading recorded nearest to
        it, because where an output has a step, a single reading may lie beyond it. The own errors
        are the mean square over the recording, or over the recorded rows nearest to the placement
        if that is more: a network is worst at the ends of its range, and just there a placement
        tells most.

        Returns: shape (placements, outputs, outputs).
        """
        near = self.nearest(placements)
        count, sensors = placements.inputs.shape
        drawn = np.random.default_rng(1).standard_normal((DRAWS, 1, sensors))
        drawn = drawn * self.noise / np.sqrt(placements.times)[:, np.newaxis]
        noise = np.zeros((count, *[placements.targets.shape[1]] * 2))
        for start in (placements.inputs, self.recorded.inputs[near[:, 0]]):
            moved = self.scene.process_real((start + drawn).reshape(-1, sensors))
            moved = moved.reshape(DRAWS, count, -1) - self.scene.process_real(start)
            moved = moved * (100 / placements.scale)
            noise += np.einsum("dro,drp->rop", moved, moved) / (2 * DRAWS)
        own = np.maximum((self.own_errors[near] ** 2).mean(axis=1), self.error**2)
        diagonal = own[:, :, np.newaxis] * np.eye(own.shape[1])
        return diagonal + noise

    def nearest(self, placements: Placements) -> NDArray[np.intp]:
        """The recorded rows with the nearest outputs, shape (placements, ``NEAREST``)."""
        recorded = self.recorded.targets
        found = np.empty((len(placements), min(NEAREST, len(recorded))), dtype=np.intp)
        for number, targets in enumerate(placements.targets):
            squares = (((recorded - targets) / placements.scale[number]) ** 2).sum(axis=1)
            # The distances are rounded, so that of equally near rows every machine takes the first.
            found[number] = squares.round(9).argsort(kind="stable")[:NEAREST]
        return found


def spread_out(count: int, most: int) -> NDArray[np.intp]:
    """Indices of at most ``most`` of ``count`` rows, evenly spread."""
    return np.linspace(0, count - 1, min(count, most)).round().astype(np.intp)


# Column of a CSV file. Rows with the same number in it are readings of one placement.
COLUMN = "placement"

# The least number of degrees of freedom from which noise is estimated. With four the standard
# deviation is known to a third.
LEAST_FREE = 4


@dataclass(frozen=True)
class Placements:
    """Known placements, each of them once, with the mean of its readings.

    inputs, shape (placements, sensors): Means of the readings as signals.
    targets, scale, shape (placements, outputs): As in ``Vectors``.
    times, shape (placements,): How often each placement was read.
    """

    inputs: Real
    targets: Real
    scale: Real
    times: Real

    def __len__(self) -> int:
        return len(self.times)

    def without(self, number: int) -> Placements:
        return self.at(np.delete(np.arange(len(self)), number))

    def at(self, numbers: NDArray[np.intp]) -> Placements:
        return Placements(
            self.inputs[numbers], self.targets[numbers], self.scale[numbers], self.times[numbers]
        )


def numbers_of(path: Path, columns: Sequence[str]) -> Real | None:
    """The column ``placement`` of a CSV file; None if it is missing or a column of the scene."""
    if COLUMN in columns or COLUMN not in read_csv_file(path).names:
        return None
    return read_table(path, [COLUMN])[:, 0]


def grouped(vectors: Vectors, numbers: Real | None) -> tuple[Placements, NDArray[np.intp]]:
    """The placements, in the order in which they first occur, and the index of that of each row.

    Rows with equal outputs may be two placements: what is not an output may differ.

    numbers, shape (rows,): Rows with the same number are one placement; None if all are different.
    """
    if numbers is None:
        numbers = np.arange(len(vectors.inputs), dtype=np.float64)
    _, first, which = np.unique(numbers, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.argsort(order)[which.ravel()]
    rows = first[order]
    other = np.flatnonzero((vectors.targets != vectors.targets[rows[place]]).any(axis=1))
    if len(other):
        row = int(other[0])
        raise InputError(
            f"column {COLUMN!r}: got {numbers[row]:g} in row {row + 1} with other outputs than in "
            f"row {rows[place[row]] + 1}, expected the same"
        )
    times = np.bincount(place).astype(np.float64)
    sums = np.zeros((len(first), vectors.inputs.shape[1]))
    np.add.at(sums, place, vectors.inputs)
    means = sums / times[:, np.newaxis]
    return Placements(means, vectors.targets[rows], vectors.scale[rows], times), place


def noise_of_repeats(vectors: Vectors, found: Placements, place: NDArray[np.intp]) -> Real | None:
    """The standard deviation of one reading of each sensor as a signal, from repeats.

    Equation: the root of the sum of the squared differences from the mean of the placement, divided
    by the degrees of freedom. With fewer than ``LEAST_FREE`` of these it is None.

    place, shape (rows,): See ``grouped``.
    """
    free = len(place) - len(found)
    if free < LEAST_FREE:
        return None
    return np.sqrt(((vectors.inputs - found.inputs[place]) ** 2).sum(axis=0) / free)
