"""Past frames as inputs: which sample of which sensor, and of how many frames before."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True)
class Tap:
    """A sample that a network takes: that of ``sensor``, ``delay`` frames before the newest."""

    sensor: int
    delay: int


@dataclass(frozen=True)
class Window:
    """The samples that a network takes, of the newest frame and of past ones.

    Parameters
    ----------
    delays : tuple of tuple of int
        For each sensor the frames before the newest whose sample is taken, ascending, each once.

    Notes
    -----
    The network takes them by delay, the newest frame first, and within a frame by sensor: without a
    past that is the frame itself.
    """

    delays: tuple[tuple[int, ...], ...]

    @cached_property
    def taps(self) -> tuple[Tap, ...]:
        """The samples, in the order in which the network takes them."""
        taps = [Tap(k, delay) for k, delays in enumerate(self.delays) for delay in delays]
        return tuple(sorted(taps, key=lambda tap: (tap.delay, tap.sensor)))

    @property
    def past(self) -> int:
        """Frames that must have come before the first that has a whole past."""
        return max(tap.delay for tap in self.taps)

    @property
    def plain(self) -> bool:
        """Whether the network takes each frame as it is."""
        return self.taps == tuple(Tap(k, 0) for k in range(len(self.delays)))

    def frames(self, samples: NDArray[Number]) -> NDArray[Number]:
        """What the network takes of each frame that has a whole past.

        Parameters
        ----------
        samples : array, shape (frames, sensors)
            Frames one after the other in time.

        Returns
        -------
        array, shape (frames - past, taps)
            None where there are no more frames than ``past``.
        """
        count = max(0, len(samples) - self.past)
        columns = [
            samples[self.past - tap.delay : self.past - tap.delay + count, tap.sensor]
            for tap in self.taps
        ]
        return np.stack(columns, axis=-1)
