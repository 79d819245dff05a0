"""Compares the constants of the Polynomial scheme with the thesis, and tests its widths."""

import tomllib

import numpy as np
import pytest

from golden.activation import polynomial
from golden.activation.polynomial import normalised, polynomial_for
from golden.input_error import InputError
from golden.numbers.fixed import cut
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from tactus.scene.data import NUMBERS

TABLE_4_2 = tomllib.loads(NUMBERS.read_text())["activation"]["polynomial"]

# A_n2 and A_n1 of Table 4.4 for Q = 3. A_n0 is printed as a_n0 / a_11.
TABLE_4_4 = [(-0.2905, 0.333, -0.0013), (-0.0238, 0.0502, 0.6890)]


def test_the_table_is_the_thesis_table() -> None:
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


def test_too_large_a_factor_names_the_thresholds() -> None:
    polynomial_for(THESIS, 14335, SIGNAL.high)
    with pytest.raises(InputError, match=r"Q = 14336: thresholds .* coincide in Fix\(14,13\)"):
        polynomial_for(THESIS, 14336, SIGNAL.high)
