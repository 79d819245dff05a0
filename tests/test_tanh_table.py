"""Compares tanh of the engine over every code with a reference in integers."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from golden.engine.formats import DROPPED, HIDDEN, PRODUCT_WIDTH, RESULT
from golden.engine.graph import Kind
from golden.engine.multiply_accumulate import MultiplyAccumulate
from golden.engine.operand_select import OperandSelect
from golden.engine.program import table_words
from golden.engine.program_memory import ProgramMemory
from golden.engine.round_saturate import RoundSaturate
from golden.engine.table_address import TableAddress
from golden.engine.tanh_table import ENDS, tanh_table
from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.transcendental import tanh_floors
from tactus.report.measure.tanh_rounding import cut, rounded, slopes, with_line, with_words
from tactus.report.measure.tanh_words import tanh_words

WIDTHS = (7, 8, 9)
CODES = np.arange(HIDDEN.low, HIDDEN.high + 1)
# The number of fraction bits of the reference.
FRAC = 40
# So fine a part of a code is enough to find a line for four codes or fewer, if there is one.
GRID = 24


def results(width: int) -> Codes:
    """tanh of every code from intercept and slope of its segment, exact and then rounded once."""
    table = tanh_table(width)
    segment = np.minimum(np.where(CODES < 0, ~CODES, CODES) >> width, len(table.slopes) - 1)
    middle = np.where(CODES < 0, -1, 1) * np.array(table.intercepts)[segment]
    distance = (CODES & ((1 << width) - 1)) - (1 << (width - 1))
    total = (middle << DROPPED) + np.array(table.slopes)[segment] * distance
    return np.clip((total + (1 << (DROPPED - 1))) >> DROPPED, RESULT.low, RESULT.high)


@pytest.fixture(scope="module")
def floors() -> Codes:
    """The floor of tanh 2**FRAC for every code from 0 on, and for one more."""
    return tanh_floors(Fraction(1, 1 << HIDDEN.frac), len(CODES) // 2 + 1, FRAC)


def errors(width: int, floors: Codes) -> Codes:
    """The distance of each result from tanh, in codes of FRAC fraction bits, to within one code."""
    exact = np.where(CODES < 0, -floors[np.abs(CODES)], floors[np.abs(CODES)])
    return np.abs((results(width) << (FRAC - RESULT.frac)) - exact)


@pytest.mark.parametrize("width", WIDTHS)
def test_within_one_unit_of_a_signal(width: int, floors: Codes) -> None:
    assert errors(width, floors).max() < 1 << (FRAC - SIGNAL.frac)


@pytest.mark.parametrize("width", WIDTHS)
def test_monotone(width: int) -> None:
    assert (np.diff(results(width)) >= 0).all()


@pytest.mark.parametrize("width", WIDTHS)
def test_odd(width: int) -> None:
    found = results(width)[1:]
    assert np.array_equal(found, -found[::-1])


@pytest.mark.parametrize("width", WIDTHS)
def test_the_blocks_compute_it(width: int) -> None:
    """Uses the blocks for address, memory, operand, sum and rounding, on every ninth code."""
    table = tanh_table(width)
    q = CODES[::9]
    address = TableAddress(width, len(table.slopes))
    words = table_words(table)
    found = ProgramMemory(words, (0,), (), address.addr_width).look_up(
        address.process(q), np.ones(len(q))
    )
    kinds = np.tile([Kind.INTERCEPT, Kind.DISTANCE], len(q))
    operand = OperandSelect(width).process(np.repeat(q, 2), kinds)
    first = kinds == Kind.INTERCEPT
    nothing = np.zeros(len(kinds), dtype=np.int64)
    sums = MultiplyAccumulate(PRODUCT_WIDTH).process(
        operand, nothing, first, np.repeat(found, 2), first, nothing
    )[1::2]
    zero = np.zeros(len(q), dtype=np.int64)
    word = RoundSaturate(PRODUCT_WIDTH).process(np.ones(len(q)), sums, zero)
    assert np.array_equal(word, results(width)[::9])


def test_the_figures_of_every_table_are_those_of_its_integers(floors: Codes) -> None:
    """The tables of an engine are compared with the reference, and all tables with each other."""
    found = {(row[0], row[1]): row[2:] for row in tanh_words(1).rows}
    unit = 1 << (FRAC - SIGNAL.frac)
    for width, end in ENDS.items():
        words, largest, _, chosen = found.pop((width, float(end)))
        assert (words, chosen) == (len(tanh_table(width).slopes), "yes")
        assert largest == errors(width, floors).max() / unit
    assert {row[-1] for row in found.values()} == {"no"}
    assert all(words == end * 2 ** (14 - width) for (width, end), (words, *_) in found.items())


def test_a_line_is_found_where_there_is_one() -> None:
    """The limits of the slope say the same as every line of a fine grid, for each short segment."""
    segments = np.array([[0, *rest] for rest in product(range(-1, 3), repeat=3)])
    for width in (2, 3, 4):
        part = np.unique(segments[:, :width], axis=0)
        climb = np.arange(1 - GRID, 2 * GRID)[:, np.newaxis] * np.arange(width)
        # The first code is 0. Half a code below a code is rounded to it.
        start = np.arange(-GRID // 2, GRID // 2)[:, np.newaxis, np.newaxis]
        codes = (start + climb + GRID // 2) // GRID
        drawn = {tuple(line) for line in codes.reshape(-1, width).tolist()}
        asked = {tuple(line) for line in part.tolist()}
        assert {tuple(line) for line in part[with_line(part)].tolist()} == drawn & asked
        assert (asked <= drawn) == (width == 2)


def test_words_of_a_segment_are_those_of_an_engine() -> None:
    """Where words were found, an engine's arithmetic with some words gives every code."""
    segments = cut(rounded(), 5)
    good = with_words(segments)
    lines = with_line(segments)
    assert set(good) < set(lines)
    shift, x = RESULT.frac - SIGNAL.frac, np.arange(-16, 16)
    half, half_word = 1 << (shift - 1), 1 << (DROPPED - 1)
    for n in (*good[:3], good[len(good) // 2], good[-1]):
        below, above = (float(limit[0]) for limit in slopes(segments[n : n + 1]))
        step = 1 << (shift + DROPPED)
        middle = int(segments[n][16]) << shift
        words = (
            ((i << DROPPED) + s * x + half_word) >> DROPPED
            for s in range(int(below * step) | 1, min(int(above * step), (1 << 17) - 1) + 1, 2)
            for i in range(middle - 24, middle + 25)
        )
        assert any(np.array_equal((word + half) >> shift, segments[n]) for word in words)


@pytest.mark.parametrize("width", [6, 10])
def test_another_width_is_refused(width: int) -> None:
    with pytest.raises(InputError, match=f"segment_width: got {width}, expected one of 7, 8, 9"):
        tanh_table(width)
