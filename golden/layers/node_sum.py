"""The bounded sum of one neuron, whether its samples come one by one or all at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.layers.weighted_sum import WeightedSum
from golden.numbers.fixed import Codes, Overflow, Rounding, requantise, signed_width


@dataclass(frozen=True)
class NodeSum(WeightedSum):
    """The sum b + sum_k w_k x_k of one neuron.

    in_fmt, coeff_fmt, out_fmt, product_shift: See ``WeightedSum``.
    weights: Codes of ``coeff_fmt``, in the order of the samples.
    bias: Code of ``coeff_fmt``.

    The sum is exact: ``acc_width`` bits hold the sum of the magnitudes of all terms, and hence
    every partial sum in any order. The result is rounded half up and saturated to ``out_fmt``. With
    no bits to drop, and a sum no wider than ``out_fmt``, neither costs hardware.
    """

    weights: tuple[int, ...]
    bias: int

    def __post_init__(self) -> None:
        super().__post_init__()
        self.coeff_fmt.check(np.array([*self.weights, self.bias]), f"{self.entity} weights")

    @property
    def acc_bound(self) -> int:
        """Largest magnitude that the sum can reach for any samples of ``in_fmt``.

        The magnitude ``|floor(w x / 2**s)|`` is largest at the most negative sample, where it is
        exact.
        """
        terms = [abs(w * self.in_fmt.low) >> self.product_shift for w in self.weights]
        return sum(terms) + abs(self.bias << self.bias_shift)

    @property
    def acc_width(self) -> int:
        """Bits of the sum. They are enough for the sum of any subset of the terms."""
        return signed_width(map(int, self.partial_sums(self.weights, self.bias)))

    @property
    def reach(self) -> int:
        """Largest magnitude that the code of the result can have."""
        return min((self.acc_bound >> self.out_shift) + 1, self.out_fmt.high)

    def scaled(self, acc: Codes) -> Codes:
        """The number that is rounded: the sum itself, unless a subclass multiplies it."""
        return acc

    def process(self, frames: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (...), for frames of samples, shape (..., inputs)."""
        exact = self.scaled(self.exact(frames))
        return requantise(exact, self.out_shift, self.out_fmt, Rounding.ROUND, Overflow.SATURATE)

    def exact(self, frames: ArrayLike) -> Codes:
        """The sums before they are scaled; see ``process``."""
        x = self.in_fmt.check(frames, f"{self.block} frames", len(self.weights))
        return self.sums(x, np.array([self.weights]), np.array([self.bias]))[..., 0]
