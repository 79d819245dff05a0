"""Tests the activation bipartite over all of its 262144 codes."""

import numpy as np
import pytest

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import FORMATS, RESULT
from golden.activation.left_out import left_out
from golden.activation.schemes import SCHEMES
from golden.numbers.fixed import Fix
from golden.numbers.precision import EXACT

FMT = EXACT.hidden_fmt
CODES = np.arange(FMT.low, FMT.high + 1)
# How many codes are not the nearest to tanh, and the largest error in units of 2**-13.
FOUND = {"block_ram": (23416, 0.708), "logic": (90322, 4.497)}


def build(memory: str, reach: int = FMT.high) -> Bipartite:
    block = SCHEMES["bipartite"].configured({"memory": memory}).build(EXACT, 1, reach)
    assert isinstance(block, Bipartite)
    return block


def tanh_units() -> np.ndarray:
    """tanh of the middle of every step, in codes of r, with an error below 2**-37 of a code."""
    return np.tanh((CODES + 0.5) * 2.0**-14) * 16384


@pytest.mark.parametrize("memory", FORMATS)
def test_error_and_wrong_codes_are_those_of_the_page(memory: str) -> None:
    results = build(memory).process(CODES)
    exact = tanh_units()
    # No tanh is so near to a whole code that its last bits could change which code is the nearest.
    assert np.abs(exact - np.rint(exact)).min() > 2**-34
    wrong, bound = FOUND[memory]
    assert int((results != np.floor(exact)).sum()) == wrong
    assert bound - 0.001 < np.abs(results + 0.5 - exact).max() / 2 < bound
    assert f"{wrong}" in str(Bipartite.__doc__)
    assert f"{bound}" in str(Bipartite.__doc__)


@pytest.mark.parametrize("memory", FORMATS)
def test_odd_monotone_and_saturated(memory: str) -> None:
    block = build(memory)
    results = block.process(CODES)
    assert (np.diff(results) >= 0).all()
    assert np.array_equal(results, ~results[::-1])
    assert (results[0], results[-1]) == (RESULT.low, RESULT.high)
    assert np.array_equal(results.reshape(2, -1), block.compute(CODES.reshape(2, -1)))


@pytest.mark.parametrize("memory", FORMATS)
def test_no_sum_overflows_and_every_word_fits(memory: str) -> None:
    block = build(memory)
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
@pytest.mark.parametrize("reach", [0, 1, 1023, 1024, 32767, 32768, 65535, 65536, 80000])
def test_words_out_of_reach_are_left_out_and_change_nothing(memory: str, reach: int) -> None:
    whole, lean = build(memory), build(memory, reach)
    assert not left_out(whole)
    assert (left_out(lean).total() > 0) == (reach < 65536)
    assert (lean.entity != whole.entity) == (reach < 65536)
    codes = np.arange(-reach - 1, reach + 1)
    assert np.array_equal(lean.process(codes), whole.process(codes))


@pytest.mark.parametrize("memory", FORMATS)
@pytest.mark.parametrize("width", [16, 18, 20])
def test_a_wider_q_saturates_and_a_narrower_one_is_the_same(memory: str, width: int) -> None:
    whole = build(memory)
    other = whole.taking(width)
    fmt = Fix(width, FMT.frac)
    codes = np.arange(fmt.low, fmt.high + 1)
    assert other.in_fmt == fmt
    assert np.array_equal(other.process(codes), whole.process(np.clip(codes, FMT.low, FMT.high)))
