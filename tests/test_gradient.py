"""Tests the assembled activation over every code that it can get."""

import numpy as np
import pytest

from golden.activation.gradient import gradient_for
from golden.activation.schemes import SCHEMES
from golden.activation.segments import gradient_real
from golden.input_error import InputError
from golden.numbers.precision import EXACT, SIGNAL, THESIS

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
