"""Compares tanh of the engine over every code with a reference in integers."""

from fractions import Fraction

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
from studies.tanh_words import study

WIDTHS = (7, 8, 9)
CODES = np.arange(HIDDEN.low, HIDDEN.high + 1)
# The number of fraction bits of the reference.
FRAC = 40


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
    rows = [tuple(row.values()) for row in study.rows()]
    found = {(row[0], row[1]): row[2:] for row in rows}
    unit = 1 << (FRAC - SIGNAL.frac)
    for width, end in ENDS.items():
        words, largest, _, chosen = found.pop((width, float(end)))
        assert (words, chosen) == (len(tanh_table(width).slopes), "yes")
        assert largest == errors(width, floors).max() / unit
    assert {row[-1] for row in found.values()} == {"no"}
    assert all(words == end * 2 ** (14 - width) for (width, end), (words, *_) in found.items())


@pytest.mark.parametrize("width", [6, 10])
def test_another_width_is_refused(width: int) -> None:
    with pytest.raises(InputError, match=f"segment_width: got {width}, expected one of 7, 8, 9"):
        tanh_table(width)
