"""Past frames as inputs: the sensor of each sample, and how many frames back it is."""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True)
class Tap:
    """A sample that a network reads: that of ``sensor``, ``delay`` frames before the newest."""

    sensor: int
    delay: int


@dataclass(frozen=True)
class Window:
    """The samples that a network reads, of the newest frame and of past frames.

    delays: For each sensor, how many frames before the newest its samples are, ascending, each
        once.

    The network reads the samples by delay, the newest frame first, and within a frame by sensor.
    Without a past this is the frame itself.
    """

    delays: tuple[tuple[int, ...], ...]

    @cached_property
    def taps(self) -> tuple[Tap, ...]:
        """The samples, in the order in which the network reads them."""
        taps = [Tap(k, delay) for k, delays in enumerate(self.delays) for delay in delays]
        return tuple(sorted(taps, key=lambda tap: (tap.delay, tap.sensor)))

    @property
    def past(self) -> int:
        """The number of frames that must have come before the first complete past."""
        return max(tap.delay for tap in self.taps)

    @property
    def plain(self) -> bool:
        """Whether the network reads each frame unchanged."""
        return self.taps == tuple(Tap(k, 0) for k in range(len(self.delays)))

    def frames(self, samples: NDArray[Number]) -> NDArray[Number]:
        """The inputs of the network for each frame that has a complete past.

        samples, shape (frames, sensors): Frames in the order of time.

        Returns, shape (frames - past, taps): Empty if there are not more frames than ``past``.
        """
        count = max(0, len(samples) - self.past)
        columns = [
            samples[self.past - tap.delay : self.past - tap.delay + count, tap.sensor]
            for tap in self.taps
        ]
        return np.stack(columns, axis=-1)
