"""What both layers share: the binary points of a sum of products."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.block import Block
from golden.fixed import Codes, Fix


@dataclass(frozen=True)
class WeightedSum(Block):
    """Bias plus products of samples and weights, each product cut before it is added.

    Parameters
    ----------
    in_fmt, coeff_fmt, out_fmt : Fix
        Formats of sample, weight and result.
    product_shift : int
        Fraction bits cut (floor) from each product before it is added: 13 in ``thesis``
        precision, 0 in ``exact``.

    Raises
    ------
    ValueError
        When the sum has fewer fraction bits than the result or the bias needs.
    """

    area = "layers"
    in_fmt: Fix
    coeff_fmt: Fix
    out_fmt: Fix
    product_shift: int

    def __post_init__(self) -> None:
        if self.acc_frac < max(self.out_fmt.frac, self.coeff_fmt.frac):
            raise ValueError(
                f"{self.entity}: the sum has {self.acc_frac} fraction bits, expected at least "
                f"those of {self.out_fmt} and {self.coeff_fmt}"
            )

    @property
    def acc_frac(self) -> int:
        """Fraction bits of the exact sum."""
        return self.in_fmt.frac + self.coeff_fmt.frac - self.product_shift

    @property
    def bias_shift(self) -> int:
        """Places by which the bias moves left to meet the sum's binary point."""
        return self.acc_frac - self.coeff_fmt.frac

    @property
    def out_shift(self) -> int:
        """Fraction bits dropped at the end."""
        return self.acc_frac - self.out_fmt.frac

    def sums(self, samples: Codes, weights: Codes, biases: Codes) -> Codes:
        """Exact sums, shape (..., rows), of checked samples, shape (..., inputs).

        Parameters
        ----------
        samples : int64 array, shape (..., inputs)
        weights : int64 array, shape (rows, inputs)
        biases : int64 array, shape (rows,)
        """
        start = biases << self.bias_shift
        bound = np.abs(weights).sum(axis=1) * -self.in_fmt.low + np.abs(start)
        # Processors multiply and shift 32 bits several at a time, 64 bits one by one.
        number = np.int32 if bound.max() < 1 << 31 else np.int64
        # Input by input, and frames last: what numpy does fastest.
        columns = np.moveaxis(samples, -1, 0).astype(number, order="C")
        column = (slice(None), *(np.newaxis,) * (samples.ndim - 1))
        acc = np.empty((len(biases), *columns.shape[1:]), dtype=number)
        acc[:] = start[column]
        products = np.empty_like(acc)
        for k in range(weights.shape[1]):
            np.multiply(weights[:, k].astype(number)[column], columns[k], out=products)
            if self.product_shift:
                products >>= self.product_shift
            acc += products
        return np.moveaxis(acc, 0, -1).astype(np.int64, copy=False)


def tree_depth(terms: int) -> int:
    """Levels, hence clocks, of an adder tree with a register per level."""
    return (terms - 1).bit_length()
