"""Compares the constants of the Gradient scheme with the thesis and with their bounds."""

import tomllib
from fractions import Fraction

import numpy as np
import pytest

from golden.activation import segments
from golden.activation.gradient import gradient_for
from golden.activation.segments import coefficient_codes
from golden.input_error import InputError
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from tactus.scene.data import NUMBERS

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
