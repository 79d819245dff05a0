"""Tests the Gradient scheme: its constants, and every code that it can get."""

import tomllib
from fractions import Fraction

import numpy as np
import pytest

from golden.activation import segments
from golden.activation.gradient import gradient_for
from golden.activation.schemes import SCHEMES
from golden.activation.segments import coefficient_codes, gradient_real
from golden.input_error import InputError
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from tactus.scene.data import NUMBERS

CASES = [(THESIS, q) for q in (1, 2, 3, 8, 16, 32, 77, 100, 128, 511, 512)] + [(EXACT, 1)]
IDS = [f"{p.name}-q{q}" for p, q in CASES]


def every_code(precision):
    return np.arange(precision.hidden_fmt.low, precision.hidden_fmt.high + 1)


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=IDS)
def test_error_against_tanh_over_every_code(precision, factor: int) -> None:
    """The scheme itself has an error of 132 units of 2**-13. The arithmetic adds less than two."""
    gradient = gradient_for(precision, factor, precision.hidden_fmt.high)
    codes = every_code(precision)
    exact = np.tanh(factor * precision.hidden_fmt.to_real(codes))
    units = np.abs(SIGNAL.to_real(gradient.process(codes)) - exact) * 8192
    assert units.max() < 134


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=IDS)
def test_odd_and_inside_the_format_over_every_code(precision, factor: int) -> None:
    gradient = gradient_for(precision, factor, precision.hidden_fmt.high)
    codes = every_code(precision)
    results = gradient.process(codes)
    assert np.abs(results).max() <= SIGNAL.high
    positive = codes[codes > 0]
    assert np.array_equal(gradient.process(-positive), -gradient.process(positive))
    lowest = precision.hidden_fmt.low
    assert gradient.process(lowest) == -gradient.process(precision.hidden_fmt.high)


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=IDS)
def test_looked_up_results_are_those_of_the_parts(precision, factor: int) -> None:
    gradient = gradient_for(precision, factor, precision.hidden_fmt.high // 3)
    codes = every_code(precision).reshape(2, -1)
    assert np.array_equal(gradient.process(codes), gradient.compute(codes))


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=IDS)
def test_the_parallel_form_gives_the_same_results(precision, factor: int) -> None:
    for reach in (precision.hidden_fmt.high, precision.hidden_fmt.high // (2 * factor)):
        one, nine = (
            SCHEMES[name].build(precision, factor, reach)
            for name in ("gradient", "gradient_parallel")
        )
        codes = np.arange(-reach, reach + 1)
        assert np.array_equal(one.process(codes), nine.process(codes))


def test_a_code_outside_the_format_is_refused() -> None:
    gradient = gradient_for(THESIS, 3, SIGNAL.high)
    with pytest.raises(InputError, match="got code 8192 at index"):
        gradient.process([0, 8192])


def test_every_q_up_to_512_is_as_exact_as_the_scheme() -> None:
    """The worst error over all factors and codes is the scheme's own step at |q| = 0.5."""
    codes = every_code(THESIS)
    worst = 0.0
    for factor in range(1, 513):
        results = SIGNAL.to_real(gradient_for(THESIS, factor, SIGNAL.high).process(codes))
        error = np.abs(results - np.tanh(factor * SIGNAL.to_real(codes)))
        worst = max(worst, 8192 * error.max())
    assert worst < 132.6


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=IDS)
def test_zero_is_in_the_first_segment(precision, factor: int) -> None:
    """Its value is the first intercept, 0.00767 or 63 units. The thesis leaves q = 0 out."""
    assert gradient_for(precision, factor, precision.hidden_fmt.high).process(0) == 63
    assert gradient_real(0.0)[0] == 0.00767


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("comparator_bank", 8192), "comparator_bank mag: got 8192, expected 0 to 8191"),
        (("g_memory", -1), "g_memory addr: got -1, expected 0 to 15"),
        (("i_memory", 16), "i_memory addr: got 16, expected 0 to 15"),
        (("grad_eqn", 0, 0, 8192), "grad_eqn intercept: got 8192, expected 0 to 8191"),
        (("grad_eqn", 0.5, 0, 0), "grad_eqn mag: got dtype float64, expected unsigned codes"),
    ],
)
def test_parts_refuse_codes_outside_their_width(arguments, message: str) -> None:
    block, *codes = arguments
    with pytest.raises(InputError, match=message):
        getattr(gradient_for(THESIS, 8, SIGNAL.high), block).process(*codes)


THESIS_TABLE = tomllib.loads(NUMBERS.read_text())["activation"]["gradient"]
FACTORS = [1, 2, 3, 5, 8, 16, 17, 18, 32, 100, 128, 511, 512]

# The first and the tenth row of Table 5.2 of the thesis, headed g_n Q_j.
TABLE_5_2 = {
    16: (0.0582, 0.0374, 0.0225, 0.0148, 0.0086, 0.0051, 0.0028, 0.001, 0.0002),
    32: (0.0291, 0.0187, 0.0112, 0.0074, 0.0043, 0.0026, 0.0014, 0.0005, 0.0001),
}


def test_the_table_is_the_thesis_table() -> None:
    assert list(segments.UPPER) == THESIS_TABLE["upper"]
    assert list(segments.GRADIENT) == THESIS_TABLE["gradient"]
    assert list(segments.INTERCEPT) == THESIS_TABLE["intercept"]


def test_thresholds_of_table_4_3_with_the_misprint_mended() -> None:
    """sigma_6 is 2.05 / 3 = 0.683, not the printed 0.633. 1.05 and 1.333 are never exceeded."""
    table = gradient_for(THESIS, 3, SIGNAL.high).table
    printed = (0.167, 0.333, 0.4, 0.5, 0.6, 0.683, 0.817)
    assert [round(t / 8192, 3) for t in table.thresholds] == list(printed)


@pytest.mark.parametrize("factor", FACTORS)
def test_every_code_is_in_the_segment_that_equation_4_23_says(factor: int) -> None:
    gradient = gradient_for(THESIS, factor, SIGNAL.high)
    mags = np.arange(SIGNAL.high + 1)
    exact = (mags[:, np.newaxis] * factor * 100 > np.array(segments.UPPER) * 819200).sum(axis=1)
    assert np.array_equal(gradient.comparator_bank.process(mags), exact)


@pytest.mark.parametrize("q", TABLE_5_2)
def test_table_5_2_holds_gradients_divided_by_q(q: int) -> None:
    assert [round(g / q, 4) for g in segments.GRADIENT] == list(TABLE_5_2[q])


def test_a_word_is_rounded_once_at_the_coarser_point() -> None:
    """Compares the words of g_memory.md for Q = 24 with its rule in exact arithmetic."""
    exact = [Fraction(str(gradient)) * 24 for gradient in segments.GRADIENT]
    own = [max(p for p in range(14) if int(g * 2**p + Fraction(1, 2)) < 2**13) for g in exact]
    common = max(p for p in range(14) if int(max(exact) * 2**p + Fraction(1, 2)) < 2**17)
    points = [min(p, common) for p in own]
    assert len(set(points)) > 1
    words = [
        int(g * 2**p + Fraction(1, 2)) * 2 ** (common - p)
        for g, p in zip(exact, points, strict=True)
    ]
    assert coefficient_codes(24, 14, 13) == (words, common)


@pytest.mark.parametrize("precision", [THESIS, EXACT], ids=lambda p: p.name)
@pytest.mark.parametrize("reach", [0.2, 0.55, 0.9])
def test_segments_out_of_reach_are_left_out_and_change_nothing(precision, reach) -> None:
    factor = 5 if precision is THESIS else 1
    limit = int(reach * (4 / 5 * 2**13 if precision is THESIS else 4 * 2**14))
    full = gradient_for(precision, factor, precision.hidden_fmt.high)
    lean = gradient_for(precision, factor, limit)
    assert len(lean.table.thresholds) < len(full.table.thresholds)
    codes = np.arange(-limit, limit + 1)
    assert np.array_equal(lean.process(codes), full.process(codes))


def test_binary_points_of_table_4_3() -> None:
    """For Q = 3, every coefficient has the binary point that the thesis prints."""
    codes, frac = coefficient_codes(3, 14, 13)
    assert frac == 13
    for code, gradient, point in zip(
        codes, segments.GRADIENT, THESIS_TABLE["binary_point_gradient"], strict=True
    ):
        assert code == int(3 * gradient * 2**point + 0.5) << (13 - point)


def test_largest_error_of_a_gradient_word() -> None:
    """It is the figure of the datasheet, over every Q that ``thesis`` accepts."""
    with pytest.raises(InputError, match=r"thresholds .* coincide|leaves"):
        gradient_for(THESIS, 1967, SIGNAL.high)
    worst = 0.0
    for factor in range(1, 1967):
        codes, frac = coefficient_codes(factor, 14, 13)
        for code, gradient, upper in zip(codes, segments.GRADIENT, segments.UPPER, strict=True):
            reach = min(1.0, upper / factor)
            worst = max(worst, abs(code / 2**frac - gradient * factor) * reach * 8192)
    assert 0.58 < worst < 0.59
