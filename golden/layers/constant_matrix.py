"""constant_matrix: all sums of a layer as one graph of shifted adds, without a multiplier."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.border import Border
from golden.fixed import Codes, Fix, signed_width
from golden.input_error import InputError
from golden.layers.closest import closest
from golden.layers.sharing import Matrix, shared
from golden.layers.shift_add import Row, ShiftAdd, clocks_of
from golden.port import CLOCK, Port, group, input_port, output_port
from golden.precision import FACTOR_LIMIT

# Dropped bits move a result by a unit or so, so a sum in the middle between two results may still
# miss the wanted one.
TRIES = 6


@dataclass(frozen=True)
class ConstantMatrix(Block):
    """y_i = floor((b_i + sum_k w_ik x_k) / 2**out_shift), except for dropped bits; saturated.

    Parameters
    ----------
    in_fmt, out_fmt : Fix
        Formats of sample and result.
    weights : tuple of tuple of int
        A row for each result, in the order of the samples.
    biases : tuple of int
        Added constants, in units of the sum.
    out_shift : int
        Number of low bits of the sum that the result does not have.
    guard : int
        Number of bits below the result's last that are still added; all bits below them are dropped
        before the addition.
    adders_per_clock : int
        Most adders in series between two registers.

    Notes
    -----
    The graph is that of ``golden.layers.sharing``. Dropping bits moves the sum of row i by a number
    between the two of ``errors[i]``, in units of the sum. They are sums, over all operands that
    lose bits, of the least and of the largest number that the lost bits can stand for. The mean
    error, if a lost bit is 1 as often as 0, is part of the constant that is added. Every number
    inside has as many bits as its bounds require. The bounds hold for all samples, so nothing
    wraps.

    Raises
    ------
    InputError
        For rows of unequal length, or numbers that are out of range.
    """

    block = "constant_matrix"
    area = "layers"
    in_fmt: Fix
    out_fmt: Fix
    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    out_shift: int
    guard: int
    adders_per_clock: int

    def __post_init__(self) -> None:
        if len({len(row) for row in self.weights}) != 1 or len(self.weights) != len(self.biases):
            raise InputError(
                f"{self.entity}: got {len(self.biases)} biases and rows of "
                f"{[len(row) for row in self.weights]} weights, expected rows of one length and a "
                "bias for each"
            )
        for name, value, least in (
            ("out_shift", self.out_shift, 0),
            ("guard", self.guard, 0),
            ("adders_per_clock", self.adders_per_clock, 1),
        ):
            if value < least:
                raise InputError(f"{self.entity}: got {name}={value}, expected {least} or more")
        most = max(abs(bias) >> self.place for bias in self.biases)
        if most >= FACTOR_LIMIT >> 1:
            raise InputError(
                f"{self.entity}: got biases up to {most} times the least place that is kept, "
                f"expected below {FACTOR_LIMIT >> 1}"
            )

    @property
    def inputs(self) -> int:
        """Number of samples of a frame."""
        return len(self.weights[0])

    @property
    def place(self) -> int:
        """The lowest bit position of the sum that is kept."""
        return max(0, self.out_shift - self.guard)

    @property
    def graph(self) -> ShiftAdd:
        """The graph of adders."""
        samples = self.in_fmt.low, self.in_fmt.high
        matrix = Matrix(self.weights, self.biases, *samples, self.place)
        return shared(matrix, self.adders_per_clock, int(self.saturates))

    @property
    def saturates(self) -> bool:
        """Whether a sum can exceed the result's format."""
        for row, bias in zip(self.weights, self.biases, strict=True):
            ends = [(w * self.in_fmt.low, w * self.in_fmt.high) for w in row]
            low, high = (bias + sum(map(end, ends)) for end in (min, max))
            if (
                low >> self.out_shift < self.out_fmt.low
                or high >> self.out_shift > self.out_fmt.high
            ):
                return True
        return False

    @property
    def clocks(self) -> tuple[int, ...]:
        """The clock in which each node of the graph is computed; samples stand in clock 0."""
        return clocks_of(self.graph, self.adders_per_clock)

    @property
    def latency(self) -> int:
        levels = self.graph.depth + int(self.saturates)
        return max(1, -(-levels // self.adders_per_clock))

    @property
    def errors(self) -> tuple[tuple[int, int], ...]:
        """The least and the largest error of each sum by dropped bits, in units of the sum."""
        graph = self.graph
        found = []
        for row, bias in zip(graph.rows, self.biases, strict=True):
            reach, unit = graph.reaches[row.node], 1 << row.shift
            ends = [unit * end for end in (reach.below, reach.above)]
            constant = graph.weights[row.node][-1] << row.shift
            if row.minus:
                inverted = 1 << (graph.lows[row.node] + row.shift)
                ends, constant = [-ends[1], -ends[0]], -constant - inverted
            found.append((ends[0] + constant - bias, ends[1] + constant - bias))
        return tuple(found)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            *group(input_port("in_data", "sample *", self.in_fmt, "in_fmt"), self.inputs),
            *group(output_port("out_data", "result *", self.out_fmt, "out_fmt"), len(self.weights)),
        )

    @property
    def result_bounds(self) -> tuple[tuple[int, int], ...]:
        """The least and the largest value of each result before it saturates."""
        bounds, found = self.graph.bounds, []
        for row in self.graph.rows:
            ends = [_result(row, end, self.drop(row)) for end in bounds[row.node]]
            found.append((min(ends), max(ends)))
        return tuple(found)

    @property
    def result_widths(self) -> tuple[int, ...]:
        """Bits of each result before it saturates."""
        return tuple(signed_width(ends) for ends in self.result_bounds)

    @property
    def ends(self) -> tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]:
        """For each row, the frames that drive its sum to its lower and to its upper end."""
        low, high = self.in_fmt.low, self.in_fmt.high
        return tuple(
            (
                tuple(high if w < 0 else low for w in row),
                tuple(low if w < 0 else high for w in row),
            )
            for row in self.weights
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        return _borders(self)

    def beside(self, row: int, at: int) -> Codes:
        """Frames whose result of a row is just below ``at``, and frames whose result just is not.

        They are always the same for the same row, so a bench that drives them comes as close to the
        border as ``borders`` says.

        Returns
        -------
        Codes, shape (frames, inputs)
        """
        return _beside(self, row, at)

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        (frames,) = inputs
        words = self.words(np.moveaxis(np.asarray(frames), -1, 0))
        return {f"result {i}": word for i, word in enumerate(words)}

    def drop(self, row: Row) -> int:
        """By how many places a row shifts the number of its node right to get the result."""
        return self.out_shift - row.shift - self.graph.lows[row.node]

    def words(self, samples: Sequence[Codes] | Codes) -> list[Codes]:
        """Results before they saturate, from the values of each sample."""
        numbers = self.graph.numbers(samples)
        return [_result(row, numbers[row.node], self.drop(row)) for row in self.graph.rows]

    def process(self, frames: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (..., rows), for frames of samples, shape (..., inputs).

        Raises
        ------
        InputError
            For a wrong last axis or a code outside ``in_fmt``.
        """
        x = self.in_fmt.check(frames, f"{self.entity} frames", self.inputs)
        words = np.stack(self.words(np.moveaxis(x, -1, 0)), axis=-1)
        return np.clip(words, self.out_fmt.low, self.out_fmt.high)

    def exact(self, frames: Codes) -> Codes:
        """The same in Python's integers, which never overflow; see ``process``."""
        words = self.words(np.moveaxis(np.asarray(frames, dtype=object), -1, 0))
        clipped = np.clip(np.stack(words, axis=-1), self.out_fmt.low, self.out_fmt.high)
        return clipped.astype(np.int64)


@lru_cache(maxsize=64)
def _borders(matrix: ConstantMatrix) -> tuple[Border, ...]:
    """The values at which each row saturates."""
    found = []
    for i, ends in enumerate(matrix.ends):
        least, most = (matrix.quantities(np.array(end))[f"result {i}"] for end in ends)
        for side, at in (("below", matrix.out_fmt.low), ("above", matrix.out_fmt.high + 1)):
            within, why = 1, ""
            if least < at <= most:
                words = matrix.quantities(matrix.beside(i, at))[f"result {i}"]
                within = int(max(at - words[words < at].max(), words[words >= at].min() - at + 1))
            else:
                why = f"result {i} is {least} to {most}"
            found.append(Border(f"result {i} saturates {side}", f"result {i}", at, within, why))
    return tuple(found)


@lru_cache(maxsize=256)
def _beside(matrix: ConstantMatrix, row: int, at: int) -> Codes:
    weights, bias, rng = np.array(matrix.weights[row]), matrix.biases[row], np.random.default_rng(0)
    found = list(matrix.ends[row])
    for word in (at - 1, at) * TRIES:
        middle = (word << matrix.out_shift) + ((1 << matrix.out_shift) >> 1)
        frame = closest(matrix.in_fmt, weights, bias, 0, middle, word == at, rng)
        if frame is not None:
            found.append(tuple(frame.tolist()))
    return np.array(found)


def _result(row: Row, number: Any, drop: int) -> Any:
    """A row's result from the number at its node, which is shifted right by ``drop`` or left."""
    number = ~number if row.minus else number
    return number >> drop if drop >= 0 else number << -drop
