"""What both layers share: a sum of products, and the binary points in it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border
from golden.numbers.fixed import Codes, Fix, Overflow, Rounding, requantise, signed_width

# How often all samples but two are chosen at random. Each choice leaves 2**28 pairs for the other
# two samples, so that few sums are missed.
CHOICES = 400


@dataclass(frozen=True)
class WeightedSum(Block):
    """Bias plus products of samples and weights; low bits of each product are dropped before.

    in_fmt, coeff_fmt, out_fmt: Formats of sample, weight and result.
    product_shift: Fraction bits that are dropped (floor) from each product before it is added: 13
        in ``thesis`` precision, 0 in ``exact``.
    """

    area = "layers"
    in_fmt: Fix
    coeff_fmt: Fix
    out_fmt: Fix
    product_shift: int

    def __post_init__(self) -> None:
        self.require(
            self.acc_frac >= max(self.out_fmt.frac, self.coeff_fmt.frac),
            f"a sum of {self.acc_frac} fraction bits",
            f"at least those of {self.out_fmt} and {self.coeff_fmt}",
        )

    @property
    def acc_frac(self) -> int:
        """Fraction bits of the exact sum."""
        return self.in_fmt.frac + self.coeff_fmt.frac - self.product_shift

    @property
    def bias_shift(self) -> int:
        """Places by which the bias is shifted left, to the binary point of the sum."""
        return self.acc_frac - self.coeff_fmt.frac

    @property
    def out_shift(self) -> int:
        """Number of fraction bits that are dropped from the sum to get the result."""
        return self.acc_frac - self.out_fmt.frac

    @property
    def ends(self) -> tuple[int, int]:
        """The least sum whose result is not below ``out_fmt``, and the least with one above."""
        half = (1 << self.out_shift) >> 1
        low, high = self.out_fmt.low, self.out_fmt.high
        return (low << self.out_shift) - half, ((high + 1) << self.out_shift) - half

    def _ends_of_terms(self, weights: ArrayLike) -> Codes:
        """What each weight contributes to a sum for the least and for the largest sample."""
        column = np.asarray(weights, dtype=np.int64)[..., np.newaxis]
        samples: Codes = np.array([self.in_fmt.low, self.in_fmt.high], dtype=np.int64)
        products: Codes = column * samples
        return products >> self.product_shift

    def partial_sums(self, weights: ArrayLike, biases: ArrayLike) -> tuple[Codes, Codes]:
        """Least and largest value of any partial sum, for all samples in any order.

        weights: shape (..., inputs).
        biases: shape (...).
        """
        terms = self._ends_of_terms(weights)
        start = np.asarray(biases, dtype=np.int64) << self.bias_shift
        least = np.minimum(terms, 0).sum(axis=(-2, -1)) + np.minimum(start, 0)
        most = np.maximum(terms, 0).sum(axis=(-2, -1)) + np.maximum(start, 0)
        return least, most

    def total(self, row: Sequence[int], bias: int, samples: Codes) -> Codes:
        """The sum of a row of weights for samples, shape (..., inputs)."""
        products = (np.array(row) * samples) >> self.product_shift
        total: Codes = (bias << self.bias_shift) + products.sum(axis=-1)
        return total

    def borders_of(
        self, quantity: str, row: Sequence[int], bias: int, factor: int = 1
    ) -> list[Border]:
        """The sums at which the result of a row saturates; ``factor`` multiplies the sum."""
        terms = self._ends_of_terms(row)
        start = bias << self.bias_shift
        least, most = (start + int(side.sum()) for side in (terms.min(axis=1), terms.max(axis=1)))
        found = []
        for name, end in zip(("saturates below", "saturates above"), self.ends, strict=True):
            at = -(-end // factor)
            within, why = 1, f"the {quantity} is {least} to {most}"
            if least < at <= most:
                below, above = self.total(row, bias, beside(self, tuple(row), bias, at))
                within, why = int(max(at - below, above - at + 1)), ""
            found.append(Border(f"{quantity} {name}", quantity, at, within, why))
        return found

    def closest(
        self, row: Sequence[int], bias: int, target: int, above: bool, rng: np.random.Generator
    ) -> Codes | None:
        """Search samples whose sum is as close to ``target`` as can be.

        With at most two weights that are not 0, no other samples are closer. With more, the search
        varies two samples at a time and tries all of their pairs; it ends early at a sum that
        cannot be improved.

        above: Whether the sum must be ``target`` or more; otherwise it must be ``target`` or less.

        Returns: None where the search finds no sum on that side.
        """
        fmt, shift, weights = self.in_fmt, self.product_shift, np.array(row)
        places, codes = np.flatnonzero(weights), np.arange(fmt.low, fmt.high + 1)
        missing = target - (bias << self.bias_shift)
        # Products without dropped bits differ by multiples of this step, so no sum is closer than
        # ``least``.
        step = 1 if shift else max(1, int(np.gcd.reduce(weights)))
        least = (-missing if above else missing) % step
        # The random samples are about as far from 0 as the target requires.
        part = missing / max(1.0, float(np.abs(weights).sum() * -fmt.low) / 2**shift)
        part = min(1.0, max(-1.0, part))
        best, found = None, None
        for _ in range(CHOICES if len(places) > 2 else 1):
            real = part * np.sign(weights) + rng.uniform(-1, 1, len(weights)) * (1 - abs(part))
            frame = np.clip(np.round(real * -fmt.low), fmt.low, fmt.high).astype(np.int64)
            pair = rng.choice(places, min(2, len(places)), replace=False)
            frame[pair] = 0
            terms = [(weights[k] * codes) >> shift for k in pair]
            second, first = (*terms, *np.zeros((2, 1), dtype=np.int64))[:2]
            rest = target - int(self.total(row, bias, frame)) - first
            # For each of the first terms the one of the second with which the sum is closest.
            order = np.argsort(second, kind="stable")
            at = np.searchsorted(second[order], rest, "left" if above else "right")
            at -= not above
            (valid,) = np.nonzero((at >= 0) & (at < len(second)))
            if not len(valid):
                continue
            gaps = np.abs(second[order[at[valid]]] - rest[valid])
            chosen = valid[rng.choice(np.flatnonzero(gaps == gaps.min()))]
            if best is None or gaps.min() < best:
                best, found = gaps.min(), frame
                found[pair] = codes[[order[at[chosen]], chosen][: len(pair)]]
            if best == least:
                break
        return found

    def sums(self, samples: Codes, weights: Codes, biases: Codes) -> Codes:
        """Exact sums, shape (..., rows), of checked samples, shape (..., inputs).

        samples: shape (..., inputs).
        weights: shape (rows, inputs).
        biases: shape (rows,).
        """
        start = biases << self.bias_shift
        bound = np.abs(weights).sum(axis=1) * -self.in_fmt.low + np.abs(start)
        # Processors multiply and shift several numbers of 32 bits at a time, but numbers of 64 bits
        # one by one.
        number = np.int32 if bound.max() < 1 << 31 else np.int64
        # numpy is fastest input by input, with the frames along the last axis.
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


@lru_cache(maxsize=4096)
def beside(layer: WeightedSum, row: tuple[int, ...], bias: int, at: int) -> Codes:
    """Samples whose sum is below ``at``, and samples whose sum is not, both close to it.

    They are always the same two for the same row, so a bench that drives them comes as close to the
    border as ``WeightedSum.borders_of`` says.

    Returns: shape (2, inputs).
    """
    # Where the search finds nothing, the extreme samples are on that side.
    ends = np.where(np.array(row) > 0, layer.in_fmt.low, layer.in_fmt.high)
    found = []
    for target, above, end in ((at - 1, False, ends), (at, True, -1 - ends)):
        frame = layer.closest(row, bias, target, above, np.random.default_rng(0))
        found.append(end if frame is None else frame)
    return np.array(found)


def tree_depth(terms: int) -> int:
    """Levels of an adder tree, which are also its clocks, with a register after each level."""
    return (terms - 1).bit_length()


@dataclass(frozen=True)
class RowSums(WeightedSum):
    """A sum for each row of weights.

    weights: Rows of codes of ``coeff_fmt``, in the order of the samples.
    biases: Codes of ``coeff_fmt``, one for each row.
    """

    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        columns = len(self.weights[0])
        self.coeff_fmt.check(np.array(self.weights), f"{self.entity} weights", columns)
        self.coeff_fmt.check(np.array(self.biases), f"{self.entity} biases", len(self.weights))

    @property
    def row_factors(self) -> tuple[int, ...]:
        """What the sum of each row is multiplied by."""
        return (1,) * len(self.weights)

    @property
    def sum_ranges(self) -> list[tuple[int, int]]:
        """For each row the least and the largest value of any partial sum."""
        ends = self.partial_sums(np.array(self.weights), np.array(self.biases))
        return list(zip(*(side.tolist() for side in ends), strict=True))

    @property
    def acc_width(self) -> int:
        """Bits of the sums. They are enough for every partial sum of every row."""
        return signed_width(end for ends in self.sum_ranges for end in ends)

    @property
    def reaches(self) -> list[int]:
        """For each row the largest magnitude that the code of its result can have.

        The magnitude of ``floor(w x / 2**s)`` is largest at the most negative sample.
        """
        terms = np.abs(np.array(self.weights) * self.in_fmt.low) >> self.product_shift
        most = terms.sum(axis=1) + np.abs(np.array(self.biases) << self.bias_shift)
        return [min((bound >> self.out_shift) + 1, self.out_fmt.high) for bound in most.tolist()]

    @property
    def borders(self) -> tuple[Border, ...]:
        rows = enumerate(zip(self.weights, self.biases, self.row_factors, strict=True))
        return tuple(
            border
            for i, (row, bias, factor) in rows
            for border in self.borders_of(f"sum {i}", row, bias, factor)
        )

    def exact(self, frames: ArrayLike) -> Codes:
        """The sums before they are scaled and rounded, shape (..., rows)."""
        x = self.in_fmt.check(frames, f"{self.entity} frames", len(self.weights[0]))
        return self.sums(x, np.array(self.weights), np.array(self.biases))

    def process(self, frames: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (..., rows), for frames of samples, shape (..., inputs)."""
        exact = self.exact(frames) * np.array(self.row_factors)
        return requantise(exact, self.out_shift, self.out_fmt, Rounding.ROUND, Overflow.SATURATE)
