"""Networks of learned functions as sums of functions, and these as small tables that are added."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Self

import numpy as np

from golden.input_error import InputError
from golden.networks.small_tables import FINE, SmallTable, tables_of
from golden.numbers.fixed import Fix
from golden.numbers.real import Real
from golden.trained.dense import Dense, DenseNetwork
from golden.trained.function import FMT, LARGEST, Function
from golden.trained.spline_basis import DEGREE

# A hidden word reaches beyond both ends of what its sum was on recorded frames by this part of it.
MARGIN = 0.0625
LEAST = 2.0**-10


@dataclass(frozen=True)
class Curve:
    """The sum of ``weight * function(gain * x + shift)`` over its terms, which are these four."""

    terms: tuple[tuple[float, float, float, Function], ...]

    def at(self, x: Real) -> Real:
        found: Real = np.zeros_like(x)
        for weight, gain, shift, function in self.terms:
            found = found + weight * function.value(gain * x + shift)
        return found

    @property
    def steepest(self) -> float:
        """A bound on its slope."""
        return sum(abs(w * gain) * _steepest(function) for w, gain, _, function in self.terms)


@dataclass(frozen=True)
class FunctionSum:
    """A constant and a curve of each of some variables.

    curves: By the number of the variable.
    """

    curves: dict[int, Curve]
    constant: float

    def with_fixed(self, fixed: Mapping[int, float]) -> FunctionSum:
        """The same sum where some of the variables have these values."""
        values = (self.curves[n].at(np.array(x)) for n, x in fixed.items() if n in self.curves)
        kept = {n: curve for n, curve in self.curves.items() if n not in fixed}
        return FunctionSum(kept, self.constant + sum(map(float, values)))


@dataclass(frozen=True)
class FunctionSums:
    """A network of learned functions.

    hidden: Of the inputs.
    ranges: Where each hidden sum lies: on recorded frames, with a margin, or else in its format.
    outputs: Of the hidden sums.
    """

    hidden: tuple[FunctionSum, ...]
    ranges: tuple[tuple[float, float], ...]
    outputs: tuple[FunctionSum, ...]


def function_sums(
    network: DenseNetwork, reached: Sequence[tuple[float, float]], design: str
) -> FunctionSums:
    """A network as sums of functions.

    network: Each node of its first layer has one input, those of the second layer add functions up.
    reached: The least and the largest sum of each node of the second layer on recorded frames;
        empty where none are known.
    design: The design that takes no other network.
    """
    if not learned(network):
        raise InputError(
            f"hardware.design: got {design!r} for a network with other layers, expected one of "
            'learned functions, as training.functions = "spline" makes them; "engine" takes any'
        )
    copies, sums, last = network.layers
    sources = [int(np.flatnonzero(row)[0]) for row in copies.weights]
    # Nodes that take the same sum look functions of it up.
    rows = [
        (*row.tolist(), bias) for row, bias in zip(sums.weights, sums.biases.tolist(), strict=True)
    ]
    places = {row: n for n, row in enumerate(dict.fromkeys(rows))}
    hidden = []
    for *row, bias in places:
        nodes = [k for k, weight in enumerate(row) if weight]
        curves = {
            source: _curve(copies, [k for k in nodes if sources[k] == source], row, source)
            for source in sorted({sources[k] for k in nodes})
        }
        hidden.append(FunctionSum(curves, bias))
    takers = [[n for n, row in enumerate(rows) if places[row] == h] for h in places.values()]
    outputs = []
    for row, bias in zip(last.weights.tolist(), last.biases.tolist(), strict=True):
        used = {h: [n for n in nodes if row[n]] for h, nodes in enumerate(takers)}
        curves = {h: _curve(sums, nodes, row, None) for h, nodes in used.items() if nodes}
        outputs.append(FunctionSum(curves, bias))
    ranges = tuple(_range(reached[nodes[0]] if reached else None) for nodes in takers)
    return FunctionSums(tuple(hidden), ranges, tuple(outputs))


def beside(networks: Sequence[FunctionSums]) -> FunctionSums:
    """Networks of the same inputs as one; each output is of the hidden sums of its own network."""
    hidden: list[FunctionSum] = []
    outputs = []
    for network in networks:
        for one in network.outputs:
            curves = {len(hidden) + h: curve for h, curve in one.curves.items()}
            outputs.append(FunctionSum(curves, one.constant))
        hidden += network.hidden
    ranges = tuple(ends for network in networks for ends in network.ranges)
    return FunctionSums(tuple(hidden), ranges, tuple(outputs))


def learned(network: DenseNetwork) -> bool:
    """Whether it is a network of learned functions."""
    if network.quantised or len(network.layers) != 3:
        return False
    copies, sums, _ = network.layers
    single = ((copies.weights != 0).sum(axis=1) == 1).all()
    return bool(copies.functions and sums.functions and single)


def _curve(layer: Dense, nodes: list[int], weights: list[float], source: int | None) -> Curve:
    """What some nodes add to a sum. With ``source`` None their own sum is the variable."""
    return Curve(
        tuple(
            (
                weights[k],
                1.0 if source is None else float(layer.weights[k, source]),
                0.0 if source is None else float(layer.biases[k]),
                layer.functions[k],
            )
            for k in nodes
        )
    )


def _range(reached: tuple[float, float] | None) -> tuple[float, float]:
    """The range of a hidden sum."""
    low, high = reached or (-LARGEST, LARGEST)
    # A sum that hardly changes has a range, too.
    margin = max(MARGIN * (high - low), LEAST)
    return max(-LARGEST, low - margin), min(LARGEST, high + margin)


@lru_cache(maxsize=256)
def _steepest(function: Function) -> float:
    if function.spline:
        # The slope of a spline is a mean of the differences of its coefficients.
        low, high, _, *coefficients = function.spline
        rises = np.abs(np.diff(coefficients))
        return float(rises.max()) * (len(coefficients) - DEGREE) / (high - low)
    q = FMT.to_real(np.arange(FMT.low, FMT.high + 1))
    return float(np.abs(np.diff(function.value(q))).max()) * 2.0**FMT.frac


_ONE = 1 << FINE
# How far the tables of a function may be from it in the square mean, in units of a last place of
# their words.
TOLERANCE = 0.7


@dataclass(frozen=True)
class Grid:
    """What the codes of a word stand for.

    centres, shape (codes,): The middle of the values of each code, from the least code.
    values, shape (codes, values of a code): All of them, or some of which no value is farther away
        than ``spread``.
    """

    centres: Real
    values: Real
    spread: float = 0.0

    @classmethod
    def of_codes(cls, fmt: Fix, bits: int) -> Self:
        """The upper bits of codes."""
        values = fmt.to_real(np.arange(fmt.low, fmt.high + 1)).reshape(1 << bits, -1)
        return cls(values.mean(axis=1), values)

    @classmethod
    def of_sums(cls, fmt: Fix, dropped: int, step: float, middle: float, error: float) -> Self:
        """Words of a format, which lack the last bits of a sum in steps, whose 0 is ``middle``.

        The sum is off by ``error`` at most, and beyond the format by a step more.
        """
        half = ((1 << dropped) - 1) / 2
        codes = np.arange(fmt.low, fmt.high + 1) * (1 << dropped)
        centres: Real = np.asarray(middle + step * (codes + half), dtype=np.float64)
        return cls(centres, centres[:, np.newaxis], error + step * (half + 1))


@dataclass(frozen=True)
class TableSum:
    """The tables of a sum, and the constant that they lack.

    constant: In steps; 0 where there are tables, because the words of one of them contain it.
    error: How far the sum can be from that of the functions.
    """

    tables: tuple[SmallTable, ...]
    constant: int
    error: float


def table_sum(
    wanted: FunctionSum, grids: Sequence[Grid], step: float, middle: float = 0.0
) -> TableSum:
    """Tables for a sum in units of ``step``, whose 0 stands for ``middle``.

    grids: For each word of a frame.
    """
    fine = step / (1 << FINE)
    constant = _whole(wanted.constant - middle, fine)
    error = fine / 2
    tables: list[SmallTable] = []
    for source, curve in sorted(wanted.curves.items()):
        grid = grids[source]
        count = len(grid.centres)
        values = _whole(curve.at(grid.centres), fine)
        # Words around 0 have the fewest bits. What is no whole step of the constant goes into the
        # first function.
        rest, centre = constant & _ONE - 1, int(values.min() + values.max()) >> 1 & -_ONE
        constant += centre - rest
        found = tables_of(source, values - centre + rest, int(TOLERANCE * _ONE))
        fmt = Fix(count.bit_length() - 1, 0)
        codes = np.arange(fmt.low, fmt.high + 1)
        words = sum((table.process(codes, fmt) for table in found), np.zeros_like(codes))
        got = fine * ((words << FINE) + centre - rest)
        error += float(np.abs(curve.at(grid.values) - got[:, np.newaxis]).max())
        error += curve.steepest * grid.spread
        tables += found
    constant >>= FINE
    if tables:
        # The table whose words become the least longer by it.
        grown = [(table.plus(constant).width - table.width, n) for n, table in enumerate(tables)]
        _, place = min(grown)
        tables[place], constant = tables[place].plus(constant), 0
    return TableSum(tuple(tables), constant, error)


def _whole(values: Any, unit: float) -> Any:
    """Values in whole units."""
    found = np.floor(np.asarray(values) / unit + 0.5).astype(np.int64)
    return found if found.ndim else int(found)
