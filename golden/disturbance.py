"""What sensors do to the readings that a network was trained on: noise and drift."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.domain import checked
from golden.real import Real

MOST = 100.0  # more than any range: the bound only keeps sums finite


@dataclass(frozen=True)
class Disturbance:
    """Noise on every reading, and drift that a sensor keeps for as long as a recording lasts.

    Equation: ``reading * (1 + g) + o + e``, with g and o drawn once for each sensor and e for each
    reading, all three from normal distributions without a mean.

    Parameters
    ----------
    noise : float
        Standard deviation of e, in the unit of the readings, 0 to 100.
    gain : float
        Standard deviation of g, a part of the reading: 0.01 is one per cent; 0 to 100.
    offset : float
        Standard deviation of o, in the unit of the readings, 0 to 100.

    Raises
    ------
    InputError
        For a number outside its range.
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
        """Whether readings stay what they are."""
        return not (self.noise or self.gain or self.offset)

    def of(
        self, readings: Real, rng: np.random.Generator, sensors: ArrayLike | None = None
    ) -> Real:
        """One recording as the sensors might give it.

        Parameters
        ----------
        readings : float array, shape (rows, columns)
        rng : numpy Generator
            The draws do not depend on the three sizes, so that what is compared for several of
            them differs in size alone.
        sensors : array_like of int, optional
            The sensor that gave each column, from 0; by default each column is one of its own.
        """
        rows, columns = readings.shape
        which = np.arange(columns) if sensors is None else np.asarray(sensors)
        count = int(which.max(initial=-1)) + 1
        gain = 1 + self.gain * rng.standard_normal(count)[which]
        offset = self.offset * rng.standard_normal(count)[which]
        disturbed: Real = (
            readings * gain + offset + self.noise * rng.standard_normal((rows, columns))
        )
        return disturbed
