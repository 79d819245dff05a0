"""What both layers share: the binary points of a sum of products."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.block import Block
from golden.border import Border
from golden.fixed import Codes, Fix
from golden.layers.closest import closest


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

    @property
    def ends(self) -> tuple[int, int]:
        """The least sum whose result is not below ``out_fmt``, the least whose result is above."""
        half = (1 << self.out_shift) >> 1
        low, high = self.out_fmt.low, self.out_fmt.high
        return (low << self.out_shift) - half, ((high + 1) << self.out_shift) - half

    def borders_of(self, quantity: str, row: Codes, bias: int, factor: int = 1) -> list[Border]:
        """Where the result of a row of weights saturates; ``factor`` multiplies its sum."""
        start = bias << self.bias_shift
        terms = [
            [(int(w) * x) >> self.product_shift for x in (self.in_fmt.low, self.in_fmt.high)]
            for w in row
        ]
        least, most = (start + sum(end(pair) for pair in terms) for end in (min, max))
        # Sums are multiples of this apart; of two samples alone only a few are there, and one
        # within a unit of the result is as good.
        within = max(1, int(np.gcd.reduce(row)) >> self.product_shift)
        if np.count_nonzero(row) <= 2:
            within = max(within, (1 << self.out_shift) // factor)
        found = []
        for name, end in zip(("saturates below", "saturates above"), self.ends, strict=True):
            at = -(-end // factor)
            why = ""
            if not least < at <= most:
                why = f"the {quantity} is {least} to {most}"
            elif np.count_nonzero(row) <= 2 and not self._reached(row, start, at, within):
                why = "no pair of samples has a sum beside it"
            found.append(Border(f"{quantity} {name}", quantity, at, within, why))
        return found

    def _reached(self, row: Codes, start: int, at: int, within: int) -> bool:
        """Whether two samples or one can bring the sum to both sides of ``at``."""
        for target, above in ((at, True), (at - 1, False)):
            frame = self.closest(row, start, target, above, np.random.default_rng(0))
            if frame is None:
                return False
            total = start + int(((np.asarray(row) * frame) >> self.product_shift).sum())
            if not at - within <= total < at + within:
                return False
        return True

    def closest(
        self, row: Codes, start: int, target: int, above: bool, rng: np.random.Generator
    ) -> Codes | None:
        """Samples whose sum is the closest to ``target``; see ``golden.layers.closest``."""
        return closest(self.in_fmt, row, start, self.product_shift, target, above, rng)

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
