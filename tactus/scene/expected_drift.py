"""The drift of a scene's sensors that is expected if no other is given."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from golden.numbers.real import Real

if TYPE_CHECKING:
    from tactus.scene.scene import Scene

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
