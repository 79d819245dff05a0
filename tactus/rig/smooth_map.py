"""A smooth function through recorded rows, fitted in a fraction of a second.

The equation is ``f(x) = b0 + b x + sum_i a_i exp(-|x - x_i|^2 / (2 l^2))``. It is the sum of a
plane, fitted by least squares, and of a kernel ridge regression for the residuals of the plane,
``(K + r I) a = values - b0 - b x``. The x_i are the rows that are fitted, with each column in units
of its standard deviation, and K holds the same exponential for every two of them. Of a few lengths
l and ridges r, those with the least error on held-out rows are used. Nothing is random.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator

from golden.numbers.real import Real

# The lengths are parts of the root of the number of inputs, with which distances grow.
LENGTHS = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)
# With less, the last bit of a float would be visible in the result.
RIDGES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
# In directions in which the inputs vary by less than this part of the largest variation, the plane
# has no slope.
SAME = 1e-6


@dataclass(frozen=True)
class SmoothMap:
    """A fitted function; the equation is that of the module.

    inputs, values, shapes (rows, inputs) and (rows, values): The rows that are fitted.
    length: l as a part of the root of the number of inputs, above 0.
    ridge: r, above 0.
    """

    inputs: Real
    values: Real
    length: float
    ridge: float

    @cached_property
    def _plane(self) -> Real:
        """b0 and b; of the possible solutions for dependent inputs, the one of least size."""
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
        rest: Real = spread(self.values) * self._rest(self._standardised(inputs))
        return self._with_one(inputs) @ self._plane + rest

    def _standardised(self, inputs: Real) -> Real:
        return (inputs - self.inputs.mean(axis=0)) / spread(self.inputs)

    def _with_one(self, inputs: Real) -> Real:
        return np.column_stack([np.ones(len(inputs)), self._standardised(inputs)])


def spread(columns: Real) -> Real:
    """The standard deviation of each column; 1 where it is constant."""
    found: Real = columns.std(axis=0)
    return np.where(found > 0, found, 1.0)


def fitted(inputs: Real, values: Real, held_inputs: Real, held_values: Real) -> SmoothMap:
    """The function with the least error on held-out rows, in units of standard deviations.

    inputs, values: shapes (rows, inputs) and (rows, values).
    """
    unit = spread(values)

    def error(found: SmoothMap) -> float:
        return float((((found(held_inputs) - held_values) / unit) ** 2).mean())

    grid = (SmoothMap(inputs, values, length, ridge) for length in LENGTHS for ridge in RIDGES)
    return min(grid, key=error)


def thinned(rows: NDArray[np.int64], most: int) -> NDArray[np.int64]:
    """At most ``most`` of the rows, evenly spread from the first to the last."""
    if len(rows) <= most:
        return rows
    return rows[np.linspace(0, len(rows) - 1, most).round().astype(np.int64)]
