"""A smooth function through recorded rows, found in a fraction of a second.

Equation: ``f(x) = b0 + b x + sum_i a_i exp(-|x - x_i|^2 / (2 l^2))``: a plane, fitted by least
squares, and what it leaves, by kernel ridge regression, ``(K + r I) a = values - b0 - b x``. The
rows x_i are those that it is fitted to, each column in standard deviations of its own, and K holds
the same exponential of every two of them. Of a few lengths l and ridges r those count that err
least on rows held out from the fit. Nothing is drawn at random.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator

from golden.real import Real

# As a part of the root of the number of inputs, which is how distances grow with it.
LENGTHS = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)
# With less, the last bit of a float would show in what comes out.
RIDGES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
# Directions in which inputs vary by less than this part of the most have no slope.
SAME = 1e-6


@dataclass(frozen=True)
class SmoothMap:
    """A fitted function; see the module.

    Parameters
    ----------
    inputs, values : float arrays, shapes (rows, inputs) and (rows, values)
        The rows that it is fitted to.
    length : float
        l as a part of the root of the number of inputs, above 0.
    ridge : float
        r, above 0.
    """

    inputs: Real
    values: Real
    length: float
    ridge: float

    @cached_property
    def _plane(self) -> Real:
        """b0 and b; of least size where inputs hang together."""
        return np.asarray(
            np.linalg.lstsq(self._with_one(self.inputs), self.values, rcond=SAME)[0], np.float64
        )

    @cached_property
    def _rest(self) -> RBFInterpolator:
        reach = self.length * math.sqrt(2 * self.inputs.shape[1])
        return RBFInterpolator(
            self._standardised(self.inputs),
            (self.values - self._with_one(self.inputs) @ self._plane) / spread(self.values),
            kernel="gaussian",
            epsilon=1 / reach,
            smoothing=self.ridge,
            degree=-1,
        )

    def __call__(self, inputs: Real) -> Real:
        """Values for inputs, shape (rows, values)."""
        rest: Real = spread(self.values) * self._rest(self._standardised(inputs))
        return self._with_one(inputs) @ self._plane + rest

    def _standardised(self, inputs: Real) -> Real:
        found: Real = (inputs - self.inputs.mean(axis=0)) / spread(self.inputs)
        return found

    def _with_one(self, inputs: Real) -> Real:
        return np.column_stack([np.ones(len(inputs)), self._standardised(inputs)])


def spread(columns: Real) -> Real:
    """The standard deviation of each column; 1 where it is constant."""
    found: Real = columns.std(axis=0)
    return np.where(found > 0, found, 1.0)


def fitted(inputs: Real, values: Real, held_inputs: Real, held_values: Real) -> SmoothMap:
    """The function that errs least on held-out rows, whose errors count in standard deviations.

    Parameters
    ----------
    inputs, values : float arrays, shapes (rows, inputs) and (rows, values)
    held_inputs, held_values : float arrays of as many columns
    """
    unit = spread(values)

    def error(found: SmoothMap) -> float:
        return float((((found(held_inputs) - held_values) / unit) ** 2).mean())

    grid = (SmoothMap(inputs, values, length, ridge) for length in LENGTHS for ridge in RIDGES)
    return min(grid, key=error)


def thinned(rows: NDArray[np.int64], most: int) -> NDArray[np.int64]:
    """So many of some rows, evenly from the first to the last; all where there are no more."""
    if len(rows) <= most:
        return rows
    return rows[np.linspace(0, len(rows) - 1, most).round().astype(np.int64)]
