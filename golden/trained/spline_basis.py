"""Cubic B-splines on equal intervals, which go on straight beyond both ends."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.numbers.real import Real

DEGREE = 3


@dataclass(frozen=True)
class Basis:
    """The cubic B-splines on ``intervals`` equal intervals from ``low`` to ``high``.

    A function is the sum of all splines, each times its coefficient. Coefficients on a straight
    line give a straight function.
    """

    low: float
    high: float
    intervals: int

    @property
    def count(self) -> int:
        return self.intervals + DEGREE

    @property
    def width(self) -> float:
        return (self.high - self.low) / self.intervals

    @property
    def centres(self) -> Real:
        """The middle of each spline. With these as coefficients, the function is x itself."""
        return np.asarray(self.low + self.width * (np.arange(self.count) - 1.0))

    def at(self, x: Real) -> tuple[Real, Real]:
        """The value and the slope of every spline at each x, shape (..., count)."""
        segment, four, rise = self._four(x)
        values, slopes = (np.zeros((x.size, self.count)) for _ in range(2))
        first = np.arange(0, x.size * self.count, self.count) + segment.ravel()
        for n in range(DEGREE + 1):
            values.reshape(-1)[first + n] = four[n].ravel()
            slopes.reshape(-1)[first + n] = rise[n].ravel()
        shape = (*x.shape, self.count)
        return values.reshape(shape), slopes.reshape(shape)

    def function(self, x: Real, coefficients: Real) -> Real:
        """The function with these coefficients at each x."""
        segment, four, _ = self._four(x)
        return np.asarray(sum(part * coefficients[segment + n] for n, part in enumerate(four)))

    def bends(self, x: Real) -> Real:
        """The second derivative of every spline at each x, shape (..., count)."""
        place = (x - self.low) / self.width
        segment = np.clip(place, 0, self.intervals - 1).astype(np.int64)
        t = place - segment
        # Beyond both ends a function is straight.
        inside = (place >= 0) & (place <= self.intervals)
        four = np.stack([1 - t, 3 * t - 2, 1 - 3 * t, t], axis=-1) / self.width**2
        found = np.zeros((*x.shape, self.count))
        places = segment[..., np.newaxis] + np.arange(DEGREE + 1)
        np.put_along_axis(found, places, four * inside[..., np.newaxis], axis=-1)
        return found

    def _four(self, x: Real) -> tuple[NDArray[np.int64], list[Real], list[Real]]:
        """The interval of each x, and the values and slopes of the four splines that are not 0."""
        place = (x - self.low) / self.width
        inside = np.clip(place, 0, self.intervals)
        segment = np.minimum(inside.astype(np.int64), self.intervals - 1)
        t, beyond = inside - segment, place - inside
        s = 1 - t
        four = s * s * s, 4 - 3 * t * t * (1 + s), 4 - 3 * s * s * (1 + t), t * t * t
        rise = -s * s, t * (3 * t - 4), s * (4 - 3 * s), t * t
        values = [part / 6 + beyond * slope / 2 for part, slope in zip(four, rise, strict=True)]
        return segment, values, [slope / (2 * self.width) for slope in rise]
