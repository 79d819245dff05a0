"""What both layers share: a sum of products, and the binary points in it."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix, Overflow, Rounding, requantise, signed_width

# How often all samples but two are chosen at random. Each choice leaves 2**28 pairs for the other
# two samples, so that few sums are missed.
CHOICES = 400


def closest(
    fmt: Fix,
    row: Codes,
    start: int,
    shift: int,
    target: int,
    above: bool,
    rng: np.random.Generator,
) -> Codes | None:
    """Search samples whose sum ``start + sum((w x) >> shift)`` is as close to ``target`` as can be.

    With at most two weights that are not 0, no other samples are closer. With more, the search
    varies two samples at a time and tries all of their pairs; it ends early at a sum that cannot be
    improved.

    fmt: Format of the samples.
    start: Number to which the products are added.
    shift: Number of low bits that are dropped from each product.
    above: Whether the sum must be ``target`` or more; otherwise it must be ``target`` or less.
    rng: Source of the random choices.

    Returns: None where the search finds no sum on that side.
    """
    places, codes = np.flatnonzero(row), np.arange(fmt.low, fmt.high + 1)
    # Products without dropped bits differ by multiples of this step, so no sum is closer than
    # ``least``.
    step = 1 if shift else max(1, int(np.gcd.reduce(row)))
    least = (start - target if above else target - start) % step
    best, found = None, None
    for _ in range(CHOICES if len(places) > 2 else 1):
        frame = _others(fmt, row, start, shift, target, rng)
        pair = rng.choice(places, min(2, len(places)), replace=False)
        frame[pair] = 0
        need = target - start - int(((row * frame) >> shift).sum())
        first, second = (
            ((row[pair[n]] * codes) >> shift if len(pair) > n else np.zeros(1, dtype=np.int64))
            for n in (1, 0)
        )
        gap, at_first, at_second = _closest_pair(first, second, need, above, rng)
        if gap is None or (best is not None and gap >= best):
            continue
        best, found = gap, frame
        for n, at in ((1, at_first), (0, at_second)):
            if len(pair) > n:
                found[pair[n]] = codes[at]
        if best == least:
            break
    return found


def _closest_pair(
    first: Codes, second: Codes, need: int, above: bool, rng: np.random.Generator
) -> tuple[int | None, int, int]:
    """The distance of the closest sum of two terms from ``need``, and the indices of both terms.

    Each list of terms must rise or fall throughout.
    """
    falls = second[0] > second[-1]
    rising = second[::-1] if falls else second
    rest = need - first
    if above:
        at = np.searchsorted(rising, rest, side="left")
    else:
        at = np.searchsorted(rising, rest, side="right") - 1
    valid = np.flatnonzero((at >= 0) & (at < len(rising)))
    if not len(valid):
        return None, 0, 0
    gaps = np.abs(rising[at[valid]] - rest[valid])
    chosen = valid[rng.choice(np.flatnonzero(gaps == gaps.min()))]
    place = int(at[chosen])
    return int(gaps.min()), int(chosen), len(second) - 1 - place if falls else place


def _others(
    fmt: Fix, row: Codes, start: int, shift: int, target: int, rng: np.random.Generator
) -> Codes:
    """Random samples that are about as far from 0 as the target requires."""
    span = max(1.0, float(np.abs(row).sum() * -fmt.low) / 2**shift)
    part = float(np.clip((target - start) / span, -1, 1))
    noise = rng.uniform(-1, 1, len(row)) * (1 - abs(part))
    real = (part * np.sign(row) + noise) * -fmt.low
    found: Codes = np.clip(np.round(real), fmt.low, fmt.high).astype(np.int64)
    return found


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

    def _ends_of_terms(self, weights: ArrayLike) -> Codes:
        """What each weight contributes to a sum for the least and for the largest sample."""
        column = np.asarray(weights, dtype=np.int64)[..., np.newaxis]
        samples: Codes = np.array([self.in_fmt.low, self.in_fmt.high], dtype=np.int64)
        products: Codes = column * samples
        return products >> self.product_shift

    def borders_of(self, quantity: str, row: Codes, bias: int, factor: int = 1) -> list[Border]:
        """The sums at which the result of a row saturates; ``factor`` multiplies the sum."""
        terms = self._ends_of_terms(row)
        start = bias << self.bias_shift
        least, most = (start + int(side.sum()) for side in (terms.min(axis=1), terms.max(axis=1)))
        found = []
        for name, end in zip(("saturates below", "saturates above"), self.ends, strict=True):
            at = -(-end // factor)
            within, why = 1, ""
            if least < at <= most:
                sums = start + ((row * self.beside(row, bias, at)) >> self.product_shift).sum(
                    axis=1
                )
                within = int(max(at - sums[0], sums[1] - at + 1))
            else:
                why = f"the {quantity} is {least} to {most}"
            found.append(Border(f"{quantity} {name}", quantity, at, within, why))
        return found

    def beside(self, row: Codes, bias: int, at: int) -> Codes:
        """Samples whose sum is below ``at``, and samples whose sum is not, both close to it.

        They are always the same two for the same row, so a bench that drives them comes as close to
        the border as ``borders_of`` says.

        Returns: shape (2, inputs).
        """
        return _beside(self, tuple(int(weight) for weight in row), bias, at)

    def closest(
        self, row: Codes, start: int, target: int, above: bool, rng: np.random.Generator
    ) -> Codes | None:
        """Search samples whose sum is closest to ``target``; see ``closest``."""
        weights = np.asarray(row, dtype=np.int64)
        return closest(self.in_fmt, weights, start, self.product_shift, target, above, rng)

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
def _beside(layer: WeightedSum, weights: tuple[int, ...], bias: int, at: int) -> Codes:
    row, start = np.array(weights), bias << layer.bias_shift
    ends = np.where(row > 0, layer.in_fmt.low, layer.in_fmt.high)
    found = []
    for target, above, end in ((at - 1, False, ends), (at, True, -1 - ends)):
        frame = layer.closest(row, start, target, above, np.random.default_rng(0))
        # Where the search finds nothing, the extreme samples are on that side.
        frame = end if frame is None else frame
        total = start + int(((row * frame) >> layer.product_shift).sum())
        if (total >= at) is not above:
            raise InputError(
                f"{layer.entity}: got a border at {at}, which no sum of {weights} meets"
            )
        found.append(frame)
    return np.array(found)


def tree_depth(terms: int) -> int:
    """Levels of an adder tree, which are also its clocks, with a register after each level."""
    return (terms - 1).bit_length()


@dataclass(frozen=True)
class NodeSum(WeightedSum):
    """The sum b + sum_k w_k x_k of one neuron.

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
    def borders(self) -> tuple[Border, ...]:
        rows = enumerate(zip(self.weights, self.biases, self.row_factors, strict=True))
        return tuple(
            border
            for i, (row, bias, factor) in rows
            for border in self.borders_of(f"sum {i}", np.array(row), bias, factor)
        )

    def exact(self, frames: ArrayLike) -> Codes:
        """The sums before they are scaled and rounded, shape (..., rows)."""
        x = self.in_fmt.check(frames, f"{self.entity} frames", len(self.weights[0]))
        return self.sums(x, np.array(self.weights), np.array(self.biases))
