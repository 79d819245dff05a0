"""constant_matrix: all sums of a layer as one graph of shifted adds, without a multiplier."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Port, group, input_port, output_port
from golden.input_error import InputError
from golden.layers.sharing import Wanted, graph_of
from golden.layers.shift_add import Ends, Row, ShiftAdd, sum_ends
from golden.numbers.fixed import Codes, Fix, signed_width
from golden.numbers.precision import FACTOR_LIMIT

# Twins compute in 64 bits.
_MOST_WIDTH = 62


@dataclass(frozen=True)
class Finish:
    """What becomes of a row's sum besides being cut and saturated.

    rectified: A result below 0 becomes 0, which is a ReLU.
    even: If all bits that the result drops are 0, the last bit of the result becomes 0. If half a
        unit of the result is part of the bias, this rounds halves to the even result.
    """

    rectified: bool = False
    even: bool = False


@dataclass(frozen=True)
class ConstantMatrix(Block):
    """y_i = floor((b_i + sum_k w_ik x_k) / 2**out_shift), except for dropped bits; then finished.

    A result is saturated. A row may have more of a finish; see ``Finish``.

    in_fmt, out_fmt: Formats of sample and result.
    weights: A row for each result, in the order of the samples.
    biases: Added constants, in units of the sum.
    out_shift: Number of low bits of the sum that the result does not have.
    guard: Number of bits below the result's last that are still added; all bits below them are
        dropped before the addition.
    adders_per_clock: Most adders in series between two registers.
    finishes: One for each row; empty for results that are saturated alone.
    in_ends: For each sample its least and its largest code; empty for those of ``in_fmt``. No other
        code may come.
    adder_operands: The most operands of an adder, 2 or 3. An adder of three needs a LUT for each
        bit where LUTs have six inputs, and about two where they have four. It counts as one adder
        in ``adders_per_clock``.
    search_runs: How many runs the search for the graph has; 0 for up to 40, fewer for a large
        matrix. The graph of more runs never has more bits of adders in as many clocks. It takes
        longer to find and is kept in the store.

    The graph is that of ``golden.layers.sharing``. Dropping bits moves the sum of row i by a number
    between the two of ``errors[i]``, in units of the sum. They are sums, over all operands that
    lose bits, of the least and of the largest number that the lost bits can stand for. The mean
    error, if a lost bit is 1 as often as 0, is part of the constant that is added. Every number
    inside has as many bits as its bounds require. The bounds hold for all samples, so nothing
    wraps.
    """

    block = "constant_matrix"
    part_of = "adder_graph"
    area = "layers"
    in_fmt: Fix
    out_fmt: Fix
    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    out_shift: int
    guard: int
    adders_per_clock: int
    finishes: tuple[Finish, ...] = ()
    in_ends: Ends = ()
    adder_operands: int = 2
    search_runs: int = 0

    def __post_init__(self) -> None:
        from_0 = (0, None)
        self.check(out_shift=from_0, guard=from_0, adders_per_clock=(1, None), search_runs=from_0)
        self.check(adder_operands=(2, 3))
        width = max(map(signed_width, self.sum_ends))
        if width > _MOST_WIDTH:
            raise InputError(
                f"{self.entity}: got sums of {width} bits, expected {_MOST_WIDTH} at most"
            )
        most = max(abs(bias) >> self.place for bias in self.biases)
        if most >= FACTOR_LIMIT >> 1:
            raise InputError(
                f"{self.entity}: got biases up to {most} times the least place that is kept, "
                f"expected below {FACTOR_LIMIT >> 1}"
            )

    @property
    def inputs(self) -> int:
        return len(self.weights[0])

    @property
    def place(self) -> int:
        """The lowest bit position of the sum that is kept."""
        return max(0, self.out_shift - self.guard)

    @property
    def sample_ends(self) -> Ends:
        """For each sample its least and its largest code."""
        return self.in_ends or ((self.in_fmt.low, self.in_fmt.high),) * self.inputs

    @property
    def sum_ends(self) -> list[tuple[int, int]]:
        """For each row the least and the largest value of its exact sum."""
        pairs = zip(self.weights, self.biases, strict=True)
        return [sum_ends(row, bias, self.sample_ends) for row, bias in pairs]

    @cached_property
    def graph(self) -> ShiftAdd:
        return graph_of(
            Wanted(
                self.weights,
                self.biases,
                self.sample_ends,
                self.place,
                self.adders_per_clock,
                self.finish_levels,
                self.adder_operands,
                self.search_runs,
            )
        )

    def __getstate__(self) -> dict[str, object]:
        """The fields and the graph, so that a bench that is given the twin need not search it."""
        return {**vars(self), "graph": self.graph}

    @property
    def row_finishes(self) -> tuple[Finish, ...]:
        return self.finishes or (Finish(),) * len(self.weights)

    @property
    def result_lows(self) -> tuple[int, ...]:
        return tuple(0 if f.rectified else self.out_fmt.low for f in self.row_finishes)

    @property
    def saturates(self) -> bool:
        """Whether a sum can be below the least result of its row or above the largest."""
        return any(
            low >> self.out_shift < least or high >> self.out_shift > self.out_fmt.high
            for least, (low, high) in zip(self.result_lows, self.sum_ends, strict=True)
        )

    @property
    def finish_levels(self) -> int:
        """How many levels of LUTs follow the last adder of a row, counted as adders."""
        return int(self.saturates or any(finish.even for finish in self.row_finishes))

    @property
    def clocks(self) -> tuple[int, ...]:
        """The clock in which each node of the graph is computed; samples stand in clock 0."""
        levels = self.graph.levels
        return tuple(max(0, -(-level // self.adders_per_clock) - 1) for level in levels)

    @property
    def latency(self) -> int:
        levels = self.graph.depth + self.finish_levels
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
            *group(input_port("in_data", "sample *", self.in_fmt), self.inputs),
            *group(output_port("out_data", "result *", self.out_fmt), len(self.weights)),
        )

    @property
    def result_bounds(self) -> tuple[tuple[int, int], ...]:
        """The least and the largest value of each result before it is finished."""
        bounds, found = self.graph.bounds, []
        for row in self.graph.rows:
            ends = [_result(row, end, self.drop(row)) for end in bounds[row.node]]
            found.append((min(ends), max(ends)))
        return tuple(found)

    @property
    def result_widths(self) -> tuple[int, ...]:
        return tuple(signed_width(ends) for ends in self.result_bounds)

    @property
    def result_ends(self) -> Ends:
        """The least and the largest value of each result."""
        high, pairs = self.out_fmt.high, zip(self.result_lows, self.result_bounds, strict=True)
        return tuple(
            (min(high, max(low, least)), min(high, max(low, most))) for low, (least, most) in pairs
        )

    def drop(self, row: Row) -> int:
        """By how many places a row shifts the number of its node right to get the result."""
        return self.out_shift - row.shift - self.graph.lows[row.node]

    def words(self, samples: Sequence[Codes] | Codes) -> list[Codes]:
        """Results before they saturate or are rectified, from the values of each sample."""
        numbers, found = self.graph.numbers(samples), []
        for row, finish in zip(self.graph.rows, self.row_finishes, strict=True):
            number, drop = numbers[row.node], self.drop(row)
            result = _result(row, number, drop)
            if finish.even:
                dropped = (~number if row.minus else number) & ((1 << max(0, drop)) - 1)
                result = result - (result & 1) * (dropped == 0)
            found.append(result)
        return found

    def process(self, frames: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (..., rows), for frames of samples, shape (..., inputs).

        A code outside ``in_ends`` gives what the exact sum would, not what the hardware does.
        """
        x = self.in_fmt.check(frames, f"{self.entity} frames", self.inputs)
        words = np.stack(self.words(np.moveaxis(x, -1, 0)), axis=-1)
        return np.clip(words, self.result_lows, self.out_fmt.high)

    def exact(self, frames: Codes) -> Codes:
        """The same in Python's integers, which never overflow; see ``process``."""
        words = self.words(np.moveaxis(np.asarray(frames, dtype=object), -1, 0))
        clipped = np.clip(np.stack(words, axis=-1), self.result_lows, self.out_fmt.high)
        return clipped.astype(np.int64)


def _result(row: Row, number: Any, drop: int) -> Any:
    """A row's result from the number at its node, which is shifted right by ``drop`` or left."""
    number = ~number if row.minus else number
    return number >> drop if drop >= 0 else number << -drop
