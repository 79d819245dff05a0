"""Tests the activation precise over all of its 262144 codes."""

from fractions import Fraction

import numpy as np
import pytest

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import FORMATS
from golden.activation.bipartite_table import RESULT as HALF_CODES
from golden.activation.precise import Precise
from golden.activation.schemes import SCHEMES, forms
from golden.engine.formats import DROPPED, HIDDEN, RESULT
from golden.engine.tanh_table import ENDS, tanh_table
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL
from golden.numbers.transcendental import tanh_floors
from studies.tanh_words import study

FMT = EXACT.hidden_fmt
CODES = np.arange(FMT.low, FMT.high + 1)
# For each place of the coefficients: the words of the whole table, the number of codes that are not
# the correctly rounded tanh, and the largest error in units of 2**-13 below the largest code.
FORMS = {
    "precise": ("logic", 38, 12770, 0.957),
    "precise block_ram": ("block_ram", 299, 452, 0.519),
}


def build(name: str, reach: int = FMT.high) -> Precise:
    block = forms()[name].build(EXACT, 1, reach)
    assert isinstance(block, Precise)
    return block


def tanh_units() -> np.ndarray:
    """tanh of every code in units of 2**-13, with an error of less than 2**-38 of a unit."""
    return np.tanh(FMT.to_real(CODES)) * 8192


@pytest.mark.parametrize("name", FORMS)
def test_every_code_is_within_one_unit_of_tanh(name: str) -> None:
    results = build(name).process(CODES)
    error = np.abs(results - tanh_units())
    assert error.max() < 1
    # For larger q, tanh lies between the largest code and 1, so the error is up to a unit.
    free = np.abs(results) < SIGNAL.high
    assert error[free].max() == pytest.approx(
        {"precise": 0.957, "precise block_ram": 0.519}[name], abs=5e-4
    )


@pytest.mark.parametrize("name", FORMS)
def test_how_many_codes_are_not_rounded_correctly(name: str) -> None:
    """The docstring and the datasheet state the same number."""
    exact = tanh_units()
    nearest = np.minimum(np.floor(np.abs(exact) + 0.5), SIGNAL.high) * np.sign(exact)
    # No tanh is so near to half a unit that its last bits could change which code is the nearest.
    assert np.abs(np.abs(exact) % 1 - 0.5).min() > 2**-34
    wrong = int((build(name).process(CODES) != nearest).sum())
    assert wrong == FORMS[name][2]
    assert f"{wrong}" in str(Precise.__doc__)


@pytest.mark.parametrize("name", FORMS)
def test_odd_monotone_and_saturated(name: str) -> None:
    results = build(name).process(CODES)
    assert (np.diff(results) >= 0).all()
    assert np.array_equal(results[1:], -results[:0:-1])
    assert results[0] == -SIGNAL.high
    assert results[-1] == SIGNAL.high


# How many codes are not the nearest to tanh, and the largest error in units of 2**-13.
FOUND = {"block_ram": (23416, 0.708), "logic": (90322, 4.497)}


def built(memory: str, reach: int = FMT.high) -> Bipartite:
    block = SCHEMES["bipartite"].configured({"memory": memory}).build(EXACT, 1, reach)
    assert isinstance(block, Bipartite)
    return block


def middle_units() -> np.ndarray:
    """tanh of the middle of every step, in codes of r, with an error below 2**-37 of a code."""
    return np.tanh((CODES + 0.5) * 2.0**-14) * 16384


@pytest.mark.parametrize("memory", FORMATS)
def test_error_and_wrong_codes_are_those_of_the_page(memory: str) -> None:
    results = built(memory).process(CODES)
    exact = middle_units()
    # No tanh is so near to a whole code that its last bits could change which code is the nearest.
    assert np.abs(exact - np.rint(exact)).min() > 2**-34
    wrong, bound = FOUND[memory]
    assert int((results != np.floor(exact)).sum()) == wrong
    assert bound - 0.001 < np.abs(results + 0.5 - exact).max() / 2 < bound
    assert f"{wrong}" in str(Bipartite.__doc__)
    assert f"{bound}" in str(Bipartite.__doc__)


@pytest.mark.parametrize("memory", FORMATS)
def test_bipartite_is_odd_monotone_and_saturated(memory: str) -> None:
    block = built(memory)
    results = block.process(CODES)
    assert (np.diff(results) >= 0).all()
    assert np.array_equal(results, ~results[::-1])
    assert (results[0], results[-1]) == (HALF_CODES.low, HALF_CODES.high)
    assert np.array_equal(results.reshape(2, -1), block.compute(CODES.reshape(2, -1)))


@pytest.mark.parametrize("memory", FORMATS)
def test_no_sum_overflows_and_every_word_fits(memory: str) -> None:
    block = built(memory)
    fmt, table = block.formats, block.table
    mag = CODES[CODES >= 0]
    base, slope = fmt.addresses(mag, mag)
    correction = np.take(table.corrections, slope)
    sums = np.take(table.bases, base) + correction
    assert 0 <= sums.min() <= sums.max() < 1 << fmt.base_width
    assert 0 <= min(table.bases) <= max(table.bases) < 1 << fmt.base_width
    half = 1 << (table.correction_width - 1)
    assert -half <= min(table.corrections) <= max(table.corrections) < half


@pytest.mark.parametrize("memory", FORMATS)
@pytest.mark.parametrize("width", [16, 18, 20])
def test_a_wider_q_saturates_and_a_narrower_one_is_the_same(memory: str, width: int) -> None:
    whole = built(memory)
    other = whole.taking(width)
    fmt = Fix(width, FMT.frac)
    codes = np.arange(fmt.low, fmt.high + 1)
    assert other.in_fmt == fmt
    assert np.array_equal(other.process(codes), whole.process(np.clip(codes, FMT.low, FMT.high)))


WIDTHS = (7, 8, 9)
HIDDEN_CODES = np.arange(HIDDEN.low, HIDDEN.high + 1)
# The number of fraction bits of the reference.
FRAC = 40


def table_results(width: int) -> Codes:
    """tanh of every code from intercept and slope of its segment, exact and then rounded once."""
    table = tanh_table(width)
    segment = np.minimum(
        np.where(HIDDEN_CODES < 0, ~HIDDEN_CODES, HIDDEN_CODES) >> width, len(table.slopes) - 1
    )
    middle = np.where(HIDDEN_CODES < 0, -1, 1) * np.array(table.intercepts)[segment]
    distance = (HIDDEN_CODES & ((1 << width) - 1)) - (1 << (width - 1))
    total = (middle << DROPPED) + np.array(table.slopes)[segment] * distance
    return np.clip((total + (1 << (DROPPED - 1))) >> DROPPED, RESULT.low, RESULT.high)


@pytest.fixture(scope="module")
def floors() -> Codes:
    """The floor of tanh 2**FRAC for every code from 0 on, and for one more."""
    return tanh_floors(Fraction(1, 1 << HIDDEN.frac), len(HIDDEN_CODES) // 2 + 1, FRAC)


def table_errors(width: int, floors: Codes) -> Codes:
    """The distance of each result from tanh, in codes of FRAC fraction bits, to within one code."""
    exact = np.where(HIDDEN_CODES < 0, -floors[np.abs(HIDDEN_CODES)], floors[np.abs(HIDDEN_CODES)])
    return np.abs((table_results(width) << (FRAC - RESULT.frac)) - exact)


@pytest.mark.parametrize("width", WIDTHS)
def test_within_one_unit_of_a_signal(width: int, floors: Codes) -> None:
    assert table_errors(width, floors).max() < 1 << (FRAC - SIGNAL.frac)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_table_is_monotone(width: int) -> None:
    assert (np.diff(table_results(width)) >= 0).all()


@pytest.mark.parametrize("width", WIDTHS)
def test_a_table_is_odd(width: int) -> None:
    found = table_results(width)[1:]
    assert np.array_equal(found, -found[::-1])


def test_the_figures_of_every_table_are_those_of_its_integers(floors: Codes) -> None:
    """The tables of an engine are compared with the reference, and all tables with each other."""
    rows = [tuple(row.values()) for row in study.rows()]
    found = {(row[0], row[1]): row[2:] for row in rows}
    unit = 1 << (FRAC - SIGNAL.frac)
    for width, end in ENDS.items():
        words, largest, _, chosen = found.pop((width, float(end)))
        assert (words, chosen) == (len(tanh_table(width).slopes), "yes")
        assert largest == table_errors(width, floors).max() / unit
    assert {row[-1] for row in found.values()} == {"no"}
    assert all(words == end * 2 ** (14 - width) for (width, end), (words, *_) in found.items())


@pytest.mark.parametrize("width", [6, 10])
def test_another_width_is_refused(width: int) -> None:
    with pytest.raises(InputError, match=f"segment_width: got {width}, expected one of 7, 8, 9"):
        tanh_table(width)
