"""What a recording says of how drifts of the sensors, and noise, become errors of the outputs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from golden.disturbance import Disturbance
from golden.real import Real
from golden.recalibration.placements import Placements
from golden.scene import Scene
from golden.scene.scale import Scale, signals

# The drift that is expected where nobody says another: standard deviations of a gain, and of an
# offset as a part of the largest reading of its sensor.
GAIN, OFFSET = 0.05, 0.02

# Own error of a network, in percent, below which it is as good as none.
LEAST_ERROR = 0.01

# Draws of the noise of a reading.
DRAWS = 50

# Recorded rows next to a placement that say what the networks err there of themselves.
NEAREST = 3


def outputs_and_slopes(scene: Scene, samples: Real) -> tuple[Real, Real]:
    """Outputs of the networks in floating point, and their derivatives by the sensors.

    Parameters
    ----------
    scene : Scene
    samples : float array, shape (rows, sensors)
        Signals.

    Returns
    -------
    float array, shape (rows, outputs); float array, shape (rows, outputs, sensors)
    """
    rows, sensors = samples.shape
    outputs, slopes = np.empty((rows, 0)), np.empty((rows, 0, sensors))
    by_sensor = np.broadcast_to(np.eye(sensors), (rows, sensors, sensors))
    cascade = scene.arrangement == "cascade"
    for mlp in scene.mlps():
        seen = np.hstack([samples, outputs]) if cascade else samples
        hidden, bends = scene.scheme.real(seen @ mlp.w1.T + mlp.b1)
        found = np.einsum("oh,rh,hi->roi", mlp.w2, bends, mlp.w1, optimize=True)
        inner = np.concatenate([by_sensor, slopes], axis=1) if cascade else by_sensor
        outputs = np.hstack([outputs, hidden @ mlp.w2.T + mlp.b2])
        slopes = np.concatenate([slopes, found @ inner], axis=1)
    return outputs, slopes


@dataclass(frozen=True)
class Sensitivity:
    """How drifts of the sensors, and noise of readings, become errors of the outputs of a scene.

    A drift is told by ``theta``, shape (2 sensors,): what the gain of each sensor has to be
    corrected by and then what each offset has to, in standard deviations of the drift that is
    expected. So what is known beforehand is that ``theta`` has mean 0 and covariance ``I``.

    Attributes
    ----------
    scene : Scene
    gain, offset : float array, shape (sensors,)
        Standard deviations of the drift that is expected; the offset as a signal.
    noise : float array, shape (sensors,)
        Standard deviation of one reading, as a signal.
    """

    scene: Scene
    gain: Real
    offset: Real
    noise: Real

    @classmethod
    def of(cls, scene: Scene, noise: Real, drift: Disturbance | None = None) -> Sensitivity:
        """Of a scene.

        Parameters
        ----------
        scene : Scene
        noise : float array, shape (sensors,)
            As a signal.
        drift : Disturbance, optional
            Its gain and its offset, in the unit of the readings; by default a gain of ``GAIN`` and
            of each sensor an offset of ``OFFSET`` of the largest reading in the recording.
        """
        recorded, zero = scene.vectors().inputs, _zero(scene)
        if drift is None:
            largest = np.abs(recorded + zero).max(axis=0)
            return cls(scene, np.full(len(zero), GAIN), OFFSET * largest, noise)
        factors = [s.factor for s in scene.scales(scene.sensors)]
        return cls(scene, np.full(len(zero), drift.gain), drift.offset / np.array(factors), noise)

    def moves(self, samples: Real) -> Real:
        """What each number of ``theta`` adds to samples, shape (rows, 2 sensors)."""
        by_gain = (samples + _zero(self.scene)) * self.gain
        result: Real = np.hstack([by_gain, np.broadcast_to(self.offset, by_gain.shape)])
        return result

    def moved(self, samples: Real, theta: Real) -> Real:
        """Samples with a correction."""
        by_gain, by_offset = np.split(self.moves(samples) * theta, 2, axis=1)
        return samples + by_gain + by_offset

    def drifted(self, samples: Real, theta: Real, least_gain: float) -> Real:
        """Samples that the correction turns into these, as the sensors would give them now.

        Parameters
        ----------
        samples : float array, shape (rows, sensors)
        theta : float array, shape (2 sensors,)
        least_gain : float
            What stands for smaller gains of the correction, whose inverse would be of any size.
        """
        found = self.correction(theta)
        return signals(samples, [replace(s, factor=max(s.factor, least_gain)) for s in found])

    def correction(self, theta: Real) -> list[Scale]:
        """The correction of each sensor: ``offset + factor * signal`` is what networks get."""
        by_gain, by_offset = np.split(theta, 2)
        gains = by_gain * self.gain
        offsets = gains * _zero(self.scene) + by_offset * self.offset
        return [Scale(float(o), float(1 + g)) for o, g in zip(offsets, gains, strict=True)]

    def by_theta(self, slopes: Real, samples: Real) -> Real:
        """Derivatives by ``theta`` of derivatives by the sensors."""
        result: Real = np.concatenate([slopes, slopes], axis=2)
        return result * self.moves(samples)[:, np.newaxis]

    @cached_property
    def own_errors(self) -> Real:
        """What the networks err of themselves, shape (recorded rows, outputs), percent."""
        vectors = self.scene.vectors()
        result: Real = vectors.percent_errors(self.scene.process_real(vectors.inputs))
        return result

    @cached_property
    def error(self) -> Real:
        """The root mean square of these, not below ``LEAST_ERROR``, shape (outputs,)."""
        result: Real = np.maximum(np.sqrt((self.own_errors**2).mean(axis=0)), LEAST_ERROR)
        return result

    @cached_property
    def recorded(self) -> Placements:
        """The rows of the recording as placements that were read once."""
        vectors = self.scene.vectors()
        return Placements(
            vectors.inputs, vectors.targets, vectors.scale, np.ones(len(vectors.inputs))
        )

    @cached_property
    def tells(self) -> Real:
        """Derivatives by ``theta`` of the errors of the recorded rows in percent.

        Shape (recorded rows, outputs, 2 sensors).
        """
        return self.telling(self.recorded)

    @cached_property
    def squares(self) -> Real:
        """``M`` of each output, shape (outputs, 2 sensors, 2 sensors).

        A correction that is off by ``theta`` adds ``theta^T M theta`` to the mean square of the
        output's error over the recording.
        """
        result: Real = np.einsum("roi,roj->oij", self.tells, self.tells, optimize=True)
        return result / len(self.tells)

    def telling(self, placements: Placements) -> Real:
        """Derivatives by ``theta`` of the errors of placements in percent.

        Shape (placements, outputs, 2 sensors).
        """
        _, slopes = outputs_and_slopes(self.scene, placements.inputs)
        by_theta = self.by_theta(slopes, placements.inputs)
        result: Real = by_theta * (100 / placements.scale)[:, :, np.newaxis]
        return result

    def spread(self, placements: Placements) -> Real:
        """``S``, the covariance of what is no drift in the errors of placements, in percent.

        It is what the networks err of themselves, and what the noise of the readings becomes in
        the networks, from draws of it around the reading and around that recorded nearest: where an
        output has a step, a single reading may lie beyond it. The first is the mean square over the
        recording, or of the rows recorded nearest to the placement where that is more: a network is
        worst at the ends of what it was trained for, and just there a placement tells most.

        Returns
        -------
        float array, shape (placements, outputs, outputs)
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
        result: Real = diagonal + noise
        return result

    def nearest(self, placements: Placements) -> NDArray[np.intp]:
        """The recorded rows whose outputs are nearest, shape (placements, ``NEAREST``)."""
        recorded = self.recorded.targets
        found = np.empty((len(placements), min(NEAREST, len(recorded))), dtype=np.intp)
        for number, targets in enumerate(placements.targets):
            squares = (((recorded - targets) / placements.scale[number]) ** 2).sum(axis=1)
            # Rounded, so that of rows that are as near the first are taken on every machine.
            found[number] = squares.round(9).argsort(kind="stable")[:NEAREST]
        return found


def spread_out(count: int, most: int) -> NDArray[np.intp]:
    """Rows of so many, at most as many as asked for, the same distance apart."""
    return np.linspace(0, count - 1, min(count, most)).round().astype(np.intp)


def _zero(scene: Scene) -> Real:
    """What makes signals proportional to readings: the signal of reading 0 with the other sign."""
    scales = scene.scales(scene.sensors)
    return np.array([s.offset / s.factor for s in scales])
