"""The disturbance of readings by the sensors: noise and drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from golden.numbers.real import Real, checked

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


MOST = 100.0  # more than any range: the bound only keeps sums finite


@dataclass(frozen=True)
class Disturbance:
    """Noise on every reading, and a drift that each sensor keeps for a whole recording.

    Equation: ``reading * (1 + g) + o + e``, where g and o are drawn once for each sensor and e for
    each reading, all three from normal distributions with mean 0.

    noise: Standard deviation of e, in the unit of the readings, 0 to 100.
    gain: Standard deviation of g, as a part of the reading: 0.01 is one per cent; 0 to 100.
    offset: Standard deviation of o, in the unit of the readings, 0 to 100.
    """

    noise: float = 0.0
    gain: float = 0.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        checked(
            noise=(self.noise, 0, MOST), gain=(self.gain, 0, MOST), offset=(self.offset, 0, MOST)
        )

    @property
    def none(self) -> bool:
        return not (self.noise or self.gain or self.offset)

    def of(
        self, readings: Real, rng: np.random.Generator, sensors: ArrayLike | None = None
    ) -> Real:
        """A recording as disturbed sensors might give it.

        readings: shape (rows, columns).
        rng: The random numbers do not depend on the three standard deviations, so results for
            different ones are comparable.
        sensors: The sensor of each column, from 0; by default each column has its own sensor.
        """
        rows, columns = readings.shape
        which = np.arange(columns) if sensors is None else np.asarray(sensors)
        count = int(which.max(initial=-1)) + 1
        gain = 1 + self.gain * rng.standard_normal(count)[which]
        offset = self.offset * rng.standard_normal(count)[which]
        return readings * gain + offset + self.noise * rng.standard_normal((rows, columns))


# Standard deviations of the gain, and of the offset as a part of the sensor's largest reading.
GAIN, OFFSET = 0.05, 0.02


def expected_drift(scene: Scene) -> tuple[Real, Real]:
    """Standard deviations of the gain and of the offset of each sensor, the offset as a signal."""
    zero = zero_signals(scene)
    largest = np.abs(scene.vectors().inputs + zero).max(axis=0)
    return np.full(len(zero), GAIN), OFFSET * largest


def zero_signals(scene: Scene) -> Real:
    """The offset that makes signals proportional to readings: minus the signal of reading 0."""
    scales = scene.scales(scene.sensors)
    return np.array([s.offset / s.factor for s in scales])
