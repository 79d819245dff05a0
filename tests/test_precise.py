"""Tests the activation precise over all of its 262144 codes."""

import numpy as np
import pytest

from golden.activation.left_out import left_out
from golden.activation.precise import Precise
from golden.activation.schemes import forms
from golden.numbers.precision import EXACT, SIGNAL

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


@pytest.mark.parametrize("name", FORMS)
def test_looked_up_results_are_those_of_the_parts(name: str) -> None:
    block = build(name, FMT.high // 3)
    codes = CODES.reshape(2, -1)
    assert np.array_equal(block.process(codes), block.compute(codes))


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("reach", [0, 1, 2047, 2048, 30000, 65536, 80000])
def test_words_out_of_reach_are_left_out_and_change_nothing(name: str, reach: int) -> None:
    whole, lean = build(name), build(name, reach)
    form, words, *_ = FORMS[name]
    assert (whole.coefficients, whole.words, left_out(whole)) == (form, words, {})
    width = whole.formats.distance_width
    assert lean.words == min(words, 1 << (reach >> width).bit_length())
    assert sum(left_out(lean).values()) == words - lean.words
    assert (lean.entity != whole.entity) == (lean.words < words)
    codes = np.arange(-reach, reach + 1)
    assert np.array_equal(lean.process(codes), whole.process(codes))


# The bits of a segment, of t, intercept, gradient and curve, and the number of curved segments.
RULES = {"logic": (11, 6, 16, 12, 4, 32), "block_ram": (8, 3, 18, 13, 5, 320)}


def by_rule(name: str, segment: int, before: int) -> tuple[int, int, int]:
    """The intercept, gradient and curve by the rule of the page, which tries every triple."""
    width, t_bits, i_bits, g_bits, c_bits, curved = RULES[name]
    d = np.arange(1 << width)
    m, x, t = (segment << width) + d, d - (1 << (width - 1)), d >> (width - t_bits)
    exact = np.tanh(m / 2**14) * 8192
    places = g_bits + 2 + 14
    u, shift = 2.0 ** (13 - places), places - i_bits
    pairs = [(0, 0)]
    if segment < curved:
        fit = np.stack([np.ones(len(x)), u * x, -u * x * t], axis=1)
        middle = round(np.linalg.lstsq(fit, exact, rcond=None)[0][2])
        pairs = []
        for curve in range(max(0, middle - 2), min((1 << c_bits) - 1, middle + 2) + 1):
            straight = exact - u * x * (3 - curve * t)
            steep = round(np.polyfit(4 * u * x, straight, 1)[0])
            for gradient in range(steep - 5, min((1 << g_bits) - 1, steep + 5) + 1):
                if (4 * gradient + 3 - curve * t).min() >= 0:
                    pairs.append((curve, gradient))
    unit = 1 << (i_bits - 13)
    nearest = np.minimum(np.floor(exact + 0.5), 8191)
    best: tuple[int, int] = (-1, -1)
    found = (0, 0, 0)
    for curve, gradient in pairs:
        product = x * (4 * gradient + 3 - curve * t)
        # The intercept is within two units of the result in the middle of the segment.
        centre = int(exact[len(exact) // 2]) * unit
        for intercept in range(max(centre - 2 * unit, 0), centre + 3 * unit):
            if segment >= curved and intercept % unit != unit // 2:
                continue
            result = ((intercept << shift) + product) >> (places - 13)
            allowed = (
                (np.abs(result - exact) <= 1).all()
                and result[0] >= before
                and result.max() <= 8191
                and (np.diff(result) >= 0).all()
                and not (segment == 0 and result[0] != 0)
            )
            zeros = (intercept & -intercept).bit_length()
            rank = (int((result == nearest).sum()), zeros)
            if allowed and rank > best:
                best, found = rank, (intercept, gradient, curve)
    return found


@pytest.mark.parametrize(("name", "step"), [("logic", 3), ("block_ram", 23)])
def test_the_coefficients_follow_from_the_rule_of_the_page(name: str, step: int) -> None:
    """Only some segments are tested, because each takes as many trials as there are triples."""
    block = build("precise" if name == "logic" else f"precise {name}")
    table, width = block.table, RULES[name][0]
    last = len(table.intercepts) - 1
    for segment in {*range(0, last, step), last}:
        before = int(block.process(np.array((segment << width) - 1))) if segment else 0
        built = table.intercepts[segment], table.gradients[segment], table.curves[segment]
        assert by_rule(name, segment, before) == built, segment
