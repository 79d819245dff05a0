"""Tests the Pade scheme: constants, widths, gate, and when its regression settles."""

import tomllib
import warnings
from fractions import Fraction

import numpy as np
import pytest

from golden.activation import pade
from golden.activation.pade import UnsettledWarning, pade_for
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from tactus.scene.data import NUMBERS

THESIS_TABLE = tomllib.loads(NUMBERS.read_text())["activation"]["pade"]


def test_the_coefficients_are_those_of_equation_4_6() -> None:
    for ours, key in ((pade.NUMERATOR, "numerator"), (pade.DENOMINATOR, "denominator")):
        assert [1.0, *ours] == [float(Fraction(str(c))) for c in THESIS_TABLE[key]]
    assert THESIS_TABLE["stable_below"] == pade.GATE


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


def test_mean_error_of_equation_4_32() -> None:
    """With rho = 4 the thesis prints 0.09 % at Q = 3, but not its number of iterations."""
    codes = np.arange(SIGNAL.low, SIGNAL.high + 1)
    block = pade_for(THESIS, 3, SIGNAL.high, rho=4.0, iterations=24)
    error = SIGNAL.to_real(block.process(codes)) - np.tanh(3 * SIGNAL.to_real(codes))
    assert 0.05 < 200 * np.abs(error).mean() < 0.09


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
