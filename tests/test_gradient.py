"""Tests the Gradient scheme: its constants, and every code that it can get."""

import tomllib
import warnings
from fractions import Fraction

import numpy as np
import pytest

from golden.activation import pade, polynomial, segments
from golden.activation.gradient import gradient_for
from golden.activation.pade import UnsettledWarning, pade_for
from golden.activation.polynomial import normalised, polynomial_for
from golden.activation.schemes import SCHEMES
from golden.activation.segments import coefficient_codes, gradient_real
from golden.input_error import InputError
from golden.numbers.fixed import cut
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from tactus.scene.data import NUMBERS

CASES = [(THESIS, q) for q in (1, 2, 3, 8, 16, 32, 77, 100, 128, 511, 512)] + [(EXACT, 1)]
IDS = [f"{p.name}-q{q}" for p, q in CASES]


def every_code(precision):
    return np.arange(precision.hidden_fmt.low, precision.hidden_fmt.high + 1)


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=IDS)
def test_the_parallel_form_gives_the_same_results(precision, factor: int) -> None:
    for reach in (precision.hidden_fmt.high, precision.hidden_fmt.high // (2 * factor)):
        one, nine = (
            SCHEMES[name].build(precision, factor, reach)
            for name in ("gradient", "gradient_parallel")
        )
        codes = np.arange(-reach, reach + 1)
        assert np.array_equal(one.process(codes), nine.process(codes))


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


PADE_TABLE = tomllib.loads(NUMBERS.read_text())["activation"]["pade"]


def test_the_coefficients_are_those_of_equation_4_6() -> None:
    for ours, key in ((pade.NUMERATOR, "numerator"), (pade.DENOMINATOR, "denominator")):
        assert [1.0, *ours] == [float(Fraction(str(c))) for c in PADE_TABLE[key]]
    assert PADE_TABLE["stable_below"] == pade.GATE


def test_normalised_constants_of_4_5_2_3_3_with_the_misprint_mended() -> None:
    """For Q = 3, [0.012 0.012 0.0011] and [10.012 0.049 0.0159] are printed. 1 / Q^4 is 0.0123."""
    powers = 1 / np.array([3.0**4, 3.0**2, 1])
    for coefficients, right in (
        (pade.NUMERATOR, [0.0123, 0.0123, 0.0011]),
        (pade.DENOMINATOR, [0.0123, 0.0494, 0.0159]),
    ):
        assert np.array([1, *coefficients]) * powers == pytest.approx(right, abs=6e-5)


@pytest.mark.parametrize("precision", [THESIS, EXACT], ids=lambda p: p.name)
@pytest.mark.parametrize("factor", [1, 3, 5, 33, 330, 4000])
def test_the_gate_is_at_3_3(precision, factor: int) -> None:
    fmt = precision.hidden_fmt
    block = pade_for(precision, factor, fmt.high)
    inside = [m for m in range(fmt.high + 1) if 10 * m * factor <= 33 << fmt.frac][-1]
    assert block.thresholds == ((inside,) if inside < fmt.high else ())
    if block.thresholds:
        assert block.process(inside + 1) == SIGNAL.high
        assert block.process(-inside - 1) == -SIGNAL.high


@pytest.mark.parametrize("factor", [1, 2, 3, 4, 5, 8, 33, 128, 512, 4000])
@pytest.mark.parametrize("rho", [1.0, 2.5, 4.0, 4.5, 8.0])
@pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")
def test_nothing_wraps_up_to_the_gate(factor: int, rho: float) -> None:
    for precision in (THESIS, EXACT) if factor == 1 else (THESIS,):
        block = pade_for(precision, factor, precision.hidden_fmt.high, rho=rho, iterations=3)
        mags = np.arange(block.last // factor + 1)
        found = block.polynomials(mags * factor)
        assert (mags * factor).max() < 1 << block.q_width
        half = 1 << (block.ratio_width - 1)
        assert (np.abs(found["ratio"]) <= half).all()
        assert found["ratio"].max() < half
        assert found["dividend"].min() >= 0
        assert found["dividend"].max() < 1 << block.dividend_width
        every = block.polynomials(np.arange(1 << block.q_width))
        for name, width in block.widths((1 << block.q_width) - 1).items():
            assert -(1 << (width - 1)) <= every[name].min()
            assert every[name].max() < 1 << (width - 1)


@pytest.mark.parametrize("rho", [3.87, 4.0, 4.5, 6.0])
def test_precise_multiplies_18_bits_at_most(rho: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnsettledWarning)
        block = pade_for(EXACT, 1, EXACT.hidden_fmt.high, rho=rho)
    widths = block.widths(block.last)
    assert max(widths.values()) <= 18
    assert block.formats.reciprocal.width == 18
    assert block.ratio_width <= 18


def test_an_unsettled_regression_warns_with_its_distance() -> None:
    missing = r"rho = 4 with 24 iterations is 1\.46e\+03 units .* 3\.3"
    with pytest.warns(UnsettledWarning, match=missing):
        pade_for(THESIS, 5, SIGNAL.high, rho=4.0, iterations=24)
    with pytest.warns(UnsettledWarning, match="rho = 2 with 99 iterations is divergent at .* 2.37"):
        pade_for(EXACT, 1, EXACT.hidden_fmt.high, rho=2.0, iterations=99)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pade_for(THESIS, 3, SIGNAL.high, rho=4.0, iterations=24)
        pade_for(EXACT, 1, EXACT.hidden_fmt.high)
        # Codes that the neuron cannot reach have no effect.
        pade_for(EXACT, 1, 2 << 14, rho=2.0, iterations=60)


TABLE_4_2 = tomllib.loads(NUMBERS.read_text())["activation"]["polynomial"]

# A_n2 and A_n1 of Table 4.4 for Q = 3. A_n0 is printed as a_n0 / a_11.
TABLE_4_4 = [(-0.2905, 0.333, -0.0013), (-0.0238, 0.0502, 0.6890)]


def test_the_quadratics_are_those_of_the_thesis() -> None:
    assert list(polynomial.UPPER) == TABLE_4_2["upper"]
    rows = zip(*(TABLE_4_2[name] for name in ("a2", "a1", "a0")), strict=True)
    assert list(polynomial.COEFFICIENTS) == list(rows)


def test_constants_of_table_4_4_with_the_misprints_mended() -> None:
    """A_10 and A_20 are nine times those of equation 4.28, as the table does not divide by Q^2."""
    values, factor = normalised(3)
    assert factor == pytest.approx(9.681, abs=0.001)
    for row, printed in zip(values, TABLE_4_4, strict=True):
        assert row[:2] == pytest.approx(printed[:2], abs=6e-4)
        assert 9 * row[2] == pytest.approx(printed[2], abs=6e-5)
    assert values[:, 2] == pytest.approx([-0.000144, 0.0766], abs=6e-5)
    twin = polynomial_for(THESIS, 3, SIGNAL.high)
    points = twin.formats
    assert {points.quadratic.frac, points.linear.frac, points.constant.frac} == {13}
    assert (points.square_frac, points.sum_frac, points.factor_frac) == (13, 13, 10)
    assert twin.factor == round(9.68139 * 1024)


@pytest.mark.parametrize("factor", [1, 2, 3, 4, 5, 8, 16, 77, 128, 512, 4000])
def test_square_and_sum_fit_their_widths(factor: int) -> None:
    """This holds for every magnitude in the range of a quadratic."""
    for precision in (THESIS, EXACT) if factor == 1 else (THESIS,):
        fmt = precision.hidden_fmt
        twin = polynomial_for(precision, factor, fmt.high)
        last = twin.thresholds[-1] if twin.saturates else fmt.high
        mags = np.arange(last + 1)
        square = cut(mags * mags, twin.square_shift, twin.rounding)
        assert square.max() < 1 << twin.square_width <= 1 << 17
        assert twin.sum_width + (twin.factor or 0).bit_length() < 48
        rows = np.array(twin.coeffs)[np.searchsorted(twin.thresholds, mags, side="left")]
        total = (
            cut(rows[:, 0] * square, twin.quadratic_shift, twin.rounding)
            + cut(rows[:, 1] * mags, twin.linear_shift, twin.rounding)
            + (rows[:, 2] << twin.constant_shift)
        )
        half = 1 << (twin.sum_width - 1)
        assert -half <= total.min()
        assert total.max() < half


@pytest.mark.parametrize("precision", [THESIS, EXACT], ids=lambda p: p.name)
def test_zero_is_zero(precision) -> None:
    """The first quadratic is -0.00139 there, but a magnitude has no sign."""
    assert polynomial_for(precision, 1, precision.hidden_fmt.high).process(0) == 0


def test_a_thousandth_of_a_bit_changes_what_lies_closest_to_rounding() -> None:
    twin = polynomial_for(EXACT, 1, EXACT.hidden_fmt.high)
    codes = twin.closest_to_rounding(16)
    assert len(set(codes)) == 32
    exact = twin.exact(codes)
    part = np.repeat([-1, 1], 16) << (twin.out_shift - 10)
    kept, moved = (cut(sums, twin.out_shift, twin.rounding) for sums in (exact, exact + part))
    assert (moved - kept == np.sign(part)).all()


def test_too_large_a_factor_of_quadratics_names_the_thresholds() -> None:
    polynomial_for(THESIS, 14335, SIGNAL.high)
    with pytest.raises(InputError, match=r"Q = 14336: thresholds .* coincide in Fix\(14,13\)"):
        polynomial_for(THESIS, 14336, SIGNAL.high)
