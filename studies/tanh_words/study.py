"""The error of an engine's tanh against the words of its table."""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from golden.engine.formats import HIDDEN, RESULT
from golden.engine.function_table import table_results
from golden.engine.tanh_table import ENDS, fitted
from golden.numbers.precision import SIGNAL
from golden.numbers.transcendental import tanh_floors
from tactus.report.measure.table import Cell

WIDTHS = (11, 10, 9, 8, 7, 6)
TABLE_ENDS = (Fraction(4), Fraction(9, 2), Fraction(5), Fraction(11, 2), Fraction(6))
# The number of fraction bits of the reference.
FRAC = 40


def rows() -> Iterator[dict[str, Cell]]:
    """Every width of a segment, with tables that end early and late."""
    q = np.arange(HIDDEN.low, HIDDEN.high + 1)
    floors = tanh_floors(Fraction(1, 1 << HIDDEN.frac), len(q) // 2 + 1, FRAC)
    exact = np.where(q < 0, -floors[np.abs(q)], floors[np.abs(q)])
    unit = 1 << (FRAC - SIGNAL.frac)
    magnitude = (floors[np.abs(q)] + unit // 2) // unit
    nearest = np.minimum(np.where(q < 0, -magnitude, magnitude), SIGNAL.high)
    drop = RESULT.frac - SIGNAL.frac
    for width in WIDTHS:
        for end in TABLE_ENDS:
            table = fitted(width, end)
            lines = np.array(table.intercepts), np.array(table.slopes)
            found = table_results(width, False, lines, q)
            largest = np.abs((found << (FRAC - RESULT.frac)) - exact).max() / unit
            rounded = np.minimum((found + (1 << (drop - 1))) >> drop, SIGNAL.high)
            wrong = 100 * float(np.mean(rounded != nearest))
            words = len(table.slopes)
            chosen = "yes" if ENDS.get(width) == end else "no"
            yield {
                "segment width": width,
                "end": float(end),
                "words": words,
                "largest units": float(largest),
                "wrong %": wrong,
                "engine": chosen,
            }
