"""Tests every activation that a scene can name, over every code that it can get."""

import numpy as np
import pytest

from golden.activation.left_out import left_out
from golden.activation.schemes import forms
from golden.input_error import InputError
from golden.numbers.precision import SIGNAL, THESIS

FORMS = forms()
# The largest error against tanh, and against the scheme in real arithmetic, in units of 2**-13.
BOUNDS = {
    "gradient": (134, 2.5),
    "gradient_parallel": (134, 2.5),
    "lut": (224, 1.5),
    "pade": (21.5, 13),
    "polynomial": (156, 24),
    "bipartite": (0.708, 0.708),
    "bipartite logic": (4.497, 4.497),
    "precise": (0.999, 0.999),
    "precise block_ram": (0.999, 0.999),
}
BUILDS = [(name, precision) for name in FORMS for precision in FORMS[name].precisions]
BUILD_IDS = [f"{name}-{precision.name}" for name, precision in BUILDS]
CASES = [
    (name, precision, factor)
    for name, precision in BUILDS
    for factor in ((1, 2, 3, 8, 77, 512) if precision.normalise else (1,))
]
IDS = [f"{name}-{p.name}-q{q}" for name, p, q in CASES]


def every_code(precision):
    return np.arange(precision.hidden_fmt.low, precision.hidden_fmt.high + 1)


def test_every_form_has_its_bounds() -> None:
    assert set(BOUNDS) == set(FORMS)


@pytest.mark.parametrize(("name", "precision", "factor"), CASES, ids=IDS)
def test_error_over_every_code(name: str, precision, factor: int) -> None:
    block = FORMS[name].build(precision, factor, precision.hidden_fmt.high)
    codes = every_code(precision)
    q = factor * block.real_input(codes)
    results = block.real_result(block.process(codes))
    value, slope = FORMS[name].real(q.reshape(2, -1))
    assert value.shape == slope.shape == (2, len(q) // 2)
    scheme = np.clip(value.ravel(), -1, block.real_result(block.out_fmt.high))
    # The most negative code saturates, and the sign of the result at 0 may differ.
    inner = (codes > codes[0]) & (codes != 0)
    assert 8192 * np.abs(results - np.tanh(q)).max() <= BOUNDS[name][0]
    assert 8192 * np.abs(results - scheme)[inner].max() <= BOUNDS[name][1]


@pytest.mark.parametrize(("name", "precision", "factor"), CASES, ids=IDS)
def test_odd_and_inside_the_format(name: str, precision, factor: int) -> None:
    block = FORMS[name].build(precision, factor, precision.hidden_fmt.high)
    codes = every_code(precision)
    results = block.process(codes)
    assert np.array_equal(results.reshape(2, -1), block.compute(codes.reshape(2, -1)))
    if block.half_codes:
        assert np.array_equal(results, ~block.process(~codes))
        return
    assert np.abs(results).max() <= SIGNAL.high
    positive = codes[codes > 0]
    assert np.array_equal(block.process(-positive), -block.process(positive))
    assert block.process(codes[0]) == -block.process(codes[-1])


@pytest.mark.parametrize(("name", "precision"), BUILDS, ids=BUILD_IDS)
@pytest.mark.parametrize("reach", [0.01, 0.3, 1.2, 1.9, 3.0])
def test_what_is_out_of_reach_is_left_out_and_changes_nothing(name, precision, reach) -> None:
    factor = 5 if precision.normalise else 1
    limit = int(reach / factor * 2**precision.hidden_fmt.frac)
    full = FORMS[name].build(precision, factor, precision.hidden_fmt.high)
    lean = FORMS[name].build(precision, factor, limit)
    assert left_out(lean).total() > left_out(full).total() == 0
    codes = np.arange(-limit, limit + 1)
    assert np.array_equal(lean.process(codes), full.process(codes))


@pytest.mark.parametrize("name", FORMS)
def test_slope_of_the_real_scheme_is_its_rise(name: str) -> None:
    """Slopes are compared away from borders, over a distance longer than the steps of a table."""
    q = np.linspace(-5, 5, 997)
    step = 3.5 / 128 / 2
    value = FORMS[name].real
    rise = (value(q + step)[0] - value(q - step)[0]) / (2 * step)
    slope = value(q)[1]
    assert np.median(np.abs(slope - rise)) < 0.03
    assert np.abs(slope - (1 - np.tanh(q) ** 2)).max() < 0.35


@pytest.mark.parametrize(("name", "precision"), BUILDS, ids=BUILD_IDS)
def test_a_code_outside_the_format_is_refused(name: str, precision) -> None:
    fmt = precision.hidden_fmt
    block = FORMS[name].build(precision, 3 if precision.normalise else 1, fmt.high)
    with pytest.raises(InputError, match=f"{block.block} data: got code {fmt.high + 1} at index"):
        block.process([0, fmt.high + 1])


@pytest.mark.parametrize("name", [name for name in FORMS if THESIS in FORMS[name].precisions])
def test_too_large_a_factor_names_it_and_the_format(name: str) -> None:
    with pytest.raises(InputError, match=r"Q = 200000.*Fix\(14,1?\d\)"):
        FORMS[name].build(THESIS, 200_000, SIGNAL.high)
