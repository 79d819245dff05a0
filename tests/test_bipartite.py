"""Tests the activation bipartite over all of its 262144 codes."""

import re
from dataclasses import replace

import numpy as np
import pytest

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_pair import pair_for
from golden.activation.bipartite_table import FORMATS, RESULT, bipartite_table
from golden.activation.left_out import left_out
from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.numbers.fixed import Fix
from golden.numbers.precision import EXACT, THESIS
from tactus.verify.sign_off.record import read_record

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


def with_wrong_bit(
    monkeypatch: pytest.MonkeyPatch, block: Bipartite, words: str, place: int, bit: int
) -> np.ndarray:
    """The results of all codes where a bit of a word is wrong."""
    table = list(getattr(block.table, words))
    # The highest bit of a correction is its sign.
    signed = words == "corrections" and bit == block.table.correction_width - 1
    table[place] ^= -(1 << bit) if signed else 1 << bit
    wrong = replace(block.table, **{words: tuple(table)})
    with monkeypatch.context() as patch:
        patch.setattr("golden.activation.bipartite.bipartite_table", lambda _: wrong)
        return block.compute(CODES)


@pytest.mark.parametrize("name", ["bipartite", "bipartite_pair"])
def test_no_result_depends_on_a_bit_that_no_bench_tells(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    block = build("block_ram")
    right = block.compute(CODES)
    survivors = read_record("mutation", name)["words"]["survivors"]
    for one in survivors:
        found = re.fullmatch(r"\w*_(bases|corrections)\[(\d+)\] bit (\d+)", one)
        assert found, one
        words, place, bit = found[1], int(found[2]), int(found[3])
        assert (with_wrong_bit(monkeypatch, block, words, place, bit) == right).all(), one
    # A result depends on others, as the highest bit of each word that is read.
    assert (with_wrong_bit(monkeypatch, block, "corrections", 0, 8) != right).any()


@pytest.mark.parametrize("memory", FORMATS)
def test_a_wrong_bit_shows_at_the_codes_of_the_bench_or_at_none(
    memory: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    block = build(memory)
    right, shown = block.compute(CODES), block.word_codes - FMT.low
    rng, found = np.random.default_rng(1), []
    read = map(np.unique, block.formats.addresses(*2 * (CODES[CODES >= 0],)))
    places = dict(zip(("bases", "corrections"), read, strict=True))
    for words in ("bases", "corrections") * 40:
        place, bit = rng.choice(places[words]), int(rng.integers(4))
        differs = with_wrong_bit(monkeypatch, block, words, place, bit) != right
        assert differs[shown].any() == differs.any(), (words, np.flatnonzero(differs)[:3])
        found.append(bool(differs.any()))
    # With 3 bits below the result some show at no code at all; without any bit below, all do.
    assert any(found)
    assert all(found) == (block.formats.frac == 0)


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


def test_block_ram_words_are_those_of_two_memories() -> None:
    table = bipartite_table(FORMATS["block_ram"])
    assert (len(table.bases), FORMATS["block_ram"].base_width) == (1024, 17)
    assert (len(table.corrections), table.correction_width) == (2048, 9)


def test_a_pair_is_two_nodes() -> None:
    whole = build("block_ram")
    pair = pair_for(whole)
    both = pair.process(CODES, CODES[::-1])
    assert np.array_equal(both[0], whole.process(CODES))
    assert np.array_equal(both[1], whole.process(CODES)[::-1])
    with pytest.raises(InputError, match=r"bipartite_pair_logic17: got memory='logic'"):
        pair_for(build("logic"))


def test_other_formats_are_refused() -> None:
    with pytest.raises(InputError, match=r"got q in Fix\(14,13\), normalised by 3, of .*'thesis'"):
        SCHEMES["bipartite"].build(THESIS, 3, 8191)
    with pytest.raises(InputError, match=r"normalised by 2"):
        SCHEMES["bipartite"].build(EXACT, 2, 8191)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"memory": "rom"}, "got memory='rom', expected one of block_ram, logic"),
        ({"reach_width": 9}, "got reach_width=9, expected 11 to 17"),
        ({"reach_width": 18}, "got reach_width=18, expected 11 to 17"),
        ({"in_fmt": Fix(18, 13)}, r"got in_fmt=Fix\(18,13\) .*, expected 14 fraction bits"),
        ({"out_fmt": Fix(13, 12)}, r"out_fmt=Fix\(13,12\), expected 14 fraction bits and Fix\(15"),
    ],
)
def test_parameters_are_checked(changes: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(build("block_ram"), **changes)
    with pytest.raises(InputError, match="bipartite data: got code 131072"):
        build("block_ram").process(131072)
