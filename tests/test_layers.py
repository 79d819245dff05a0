"""Compares formats, layers and controllers with exact arithmetic and with their bounds."""

from __future__ import annotations

import itertools
from fractions import Fraction
from math import floor

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.layers.weighted_sum import NodeSum
from golden.numbers.fixed import Fix, Overflow, Rounding, requantise, signed_width
from golden.numbers.precision import EXACT, SIGNAL

COEFF = Fix(18, 14)
codes = st.integers(COEFF.low, COEFF.high)


@given(st.lists(codes, min_size=1, max_size=5), codes, st.integers(0, 13))
def test_accumulator_is_wide_enough_and_no_wider(weights, bias, shift) -> None:
    twin = NodeSum(SIGNAL, COEFF, EXACT.hidden_fmt, shift, tuple(weights), bias)
    half = 1 << (twin.acc_width - 1)
    largest = 0
    for rails in itertools.product((SIGNAL.low, SIGNAL.high), repeat=len(weights)):
        terms = [(w * x) >> shift for w, x in zip(weights, rails, strict=True)]
        start = bias << twin.bias_shift
        for end in range(len(terms) + 1):
            partial = start + sum(terms[:end])
            assert -half <= partial < half
        largest = max(largest, abs(start + sum(terms)), abs(sum(terms)))
    assert largest <= twin.acc_bound
    assert twin.acc_width <= max(2, twin.acc_bound.bit_length() + 1)


Q13 = Fix(14, 13)
formats = st.builds(Fix, st.integers(2, 40), st.integers(0, 40))


@given(formats, st.floats(-1e6, 1e6))
def test_quantise_is_nearest(fmt: Fix, value: float) -> None:
    codes, saturated = fmt.quantise(value)
    exact = floor(Fraction(value) * 2**fmt.frac + Fraction(1, 2))
    if abs(exact) < 2**52:  # beyond, doubles cannot hold the half
        assert int(codes) == min(max(exact, fmt.low), fmt.high)
        assert saturated == (exact != int(codes))


@given(
    st.integers(-(2**50), 2**50),
    st.integers(0, 40),
    formats,
    st.sampled_from(Rounding),
    st.sampled_from(Overflow),
)
def test_requantise_is_exact(code, shift, target, rounding, overflow) -> None:
    exact = Fraction(code, 2**shift)
    kept = floor(exact + Fraction(1, 2)) if rounding is Rounding.ROUND else floor(exact)
    if overflow is Overflow.SATURATE:
        expected = min(max(kept, target.low), target.high)
    else:
        expected = (kept - target.low) % 2**target.width + target.low
    assert int(requantise(code, shift, target, rounding, overflow)) == expected


def test_requantise_refuses_a_left_shift() -> None:
    with pytest.raises(InputError, match="shift=-1, expected 0 or more"):
        requantise(1, -1, Q13, Rounding.ROUND, Overflow.WRAP)


@given(st.integers(-(2**60), 2**60))
def test_signed_width_is_the_least(value: int) -> None:
    width = signed_width([value])
    assert -(2 ** (width - 1)) <= value < 2 ** (width - 1)
    assert width == 2 or not -(2 ** (width - 2)) <= value < 2 ** (width - 2)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_quantise_refuses_what_is_not_finite(bad: float) -> None:
    with pytest.raises(InputError, match=rf"sensors: got {bad} at index \(1,\), expected finite"):
        Q13.quantise([0.0, bad], "sensors")


def test_check_names_code_and_place() -> None:
    with pytest.raises(
        InputError, match=r"got code 8192 at index \(0, 1\), expected -8192 to 8191"
    ):
        Q13.check([[0, 8192]])
    with pytest.raises(InputError, match=r"got shape \(3,\), expected \(..., 4\)"):
        Q13.check([1, 2, 3], columns=4)
    with pytest.raises(InputError, match="got dtype float64, expected integer codes"):
        Q13.check(np.zeros(3))
    assert Q13.check([-8192, 8191]).tolist() == [-8192, 8191]


@pytest.mark.parametrize(("width", "frac"), [(1, 0), (63, 0), (14, -1)])
def test_a_format_has_limits(width: int, frac: int) -> None:
    with pytest.raises(InputError, match=r"Fix: (width|frac)="):
        Fix(width, frac)


def test_largest_frac() -> None:
    assert Fix.largest_frac(18, [0.9]) == Fix(18, 17)
    assert Fix.largest_frac(18, [1.0]) == Fix(18, 16)
    assert Fix.largest_frac(18, [-1.0]) == Fix(18, 17)
    with pytest.raises(InputError, match="weights: largest magnitude 200000 does not fit 18 bits"):
        Fix.largest_frac(18, [2e5], "weights")
