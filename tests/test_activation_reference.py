"""The approximations of chapter 4 in floating point, against closed forms and their own limits."""

import numpy as np
import pytest

from golden.activation.pade import fraction, pade_real
from golden.activation.reference import (
    inverse,
    inverse_fraction,
    pade_fraction,
    rho_regression,
    stable_below,
    taylor,
)
from golden.input_error import InputError

Q = np.linspace(-3, 3, 601)


def test_taylor_is_the_cut_series() -> None:
    power = 1 + 2 * Q + 4 * Q**2 / 2 + 8 * Q**3 / 6 + 16 * Q**4 / 24
    assert taylor(Q) == pytest.approx((power - 1) / (power + 1))


def test_the_thesis_is_right_about_series_and_fraction() -> None:
    """The series is off by up to 2.3 % of tanh for positive q, the fraction by less than 0.25 %."""
    positive = Q[Q > 0]
    worst = np.abs(taylor(positive) / np.tanh(positive) - 1).max()
    assert 100 * worst == pytest.approx(2.3, abs=0.05)
    assert 100 * np.abs(pade_fraction(Q) - np.tanh(Q)).max() < 0.25
    assert pade_fraction(1e-8) == pytest.approx(1e-8)


@pytest.mark.parametrize(
    ("rho", "limit"), [(1, 1.447), (2, 2.371), (3, 2.933), (4, 3.352), (5, 3.691)]
)
def test_stability_limits_of_rho(rho: float, limit: float) -> None:
    assert stable_below(rho) == pytest.approx(limit, abs=5e-4)
    for q, settles in ((0.999 * limit, True), (1.001 * limit, False)):
        missing = abs(rho_regression(q, rho, 8000) - pade_fraction(q))
        assert missing < 1e-3 if settles else missing > 10


def test_a_rho_that_never_settles_is_refused() -> None:
    with pytest.raises(InputError, match=r"rho: got 0.5, expected above 0.5"):
        stable_below(0.5)


def test_the_regression_step_by_step_is_its_closed_form() -> None:
    for rho, iterations in ((4.0, 1), (4.0, 24), (4.5, 32)):
        expected = np.clip(np.abs(rho_regression(Q, rho, iterations)), 0, 1) * np.sign(Q)
        assert pade_real(Q, rho, iterations)[0] == pytest.approx(expected)


def test_the_inverse_regression_settles_below_2_888_and_its_inversion_below_1_915() -> None:
    a, b = fraction(Q)
    inside = np.abs(Q) < 2.87
    assert inverse_fraction(Q, 4000)[inside] == pytest.approx((b / a)[inside])
    assert abs(inverse_fraction(2.89, 4000)) > 1e3
    z = np.array([0.1, 0.9, 1.5, 1.99])
    assert inverse(z, 4000) == pytest.approx(1 / z)
    for q, settles in ((1.90, True), (1.93, False)):
        h = inverse_fraction(q, 400)
        assert h == pytest.approx(q / np.tanh(q), rel=1e-4)
        assert (abs(q * inverse(h, 4000) - np.tanh(q)) < 1e-3) == settles
