"""A sum of functions as small tables whose words are added up."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from golden.networks.function_sums import FunctionSum
from golden.networks.small_tables import FINE, SmallTable, tables_of
from golden.numbers.fixed import Fix
from golden.numbers.real import Real

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
