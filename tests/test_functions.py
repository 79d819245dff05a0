"""Compares equations 3.17 and 3.18 in floating point with closed forms."""

import math

import numpy as np
import pytest

from golden.input_error import InputError
from golden.visualisation.functions import (
    WILBRAHAM_GIBBS,
    harmonic_limit,
    harmonic_load,
    harmonic_tail,
    power_load,
)
from tactus.scene import thesis_table

# The load, centre, half width and terms of Figure 3.27.
FIGURE_3_27 = thesis_table("load_function")["cases"]
POSITIONS = np.linspace(0, 1, 401)


def test_one_term_by_hand() -> None:
    expected = 4 * 0.5 / math.pi * math.sin(0.3 * math.pi) * math.cos(0.2 * math.pi) ** 2
    assert harmonic_load(0.2, 0.5, 0.2, 0.3, 1) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("case", FIGURE_3_27)
def test_figure_3_27(case: str) -> None:
    """The height on the pulse is d less the mean 2 d w, and the tail bounds the difference."""
    load, centre, width, terms = FIGURE_3_27[case]
    top, base = load * (1 - 2 * width), -2 * load * width
    for position, value in ((centre, top), (centre - width, top - load / 2), (0.05, base)):
        miss = abs(harmonic_load(position, load, centre, width, terms) - value)
        assert miss <= harmonic_tail(position, load, centre, width, terms) + 1e-12
    if terms == 1000:
        assert harmonic_load(centre, load, centre, width, terms) == pytest.approx(top, abs=2e-3)


def test_the_limit_is_a_pulse_without_its_mean() -> None:
    load, centre, width = 0.8, 0.6, 0.15
    pulse = np.where(np.abs(POSITIONS - centre) < width, load, 0.0)
    edge = np.isclose(np.abs(POSITIONS - centre), width)
    limit = harmonic_limit(POSITIONS, load, centre, width)
    assert np.allclose((limit + 2 * load * width)[~edge], pulse[~edge], atol=1e-12)


@pytest.mark.parametrize("terms", [50, 500])
def test_gibbs_overshoot_does_not_go_away(terms: int) -> None:
    """The peak is 1 / (P + 1) inside of the jump, and tends to 0.0895 d above the pulse."""
    load, centre, width = 0.5, 0.5, 0.25
    offsets = np.linspace(0.2, 3, 2801) / (terms + 1)
    values = harmonic_load(centre - width + offsets, load, centre, width, terms)
    overshoot = values.max() - load * (1 - 2 * width)
    assert overshoot / load == pytest.approx(WILBRAHAM_GIBBS / math.pi - 0.5, abs=3 / terms)
    assert offsets[np.argmax(values)] * (terms + 1) == pytest.approx(1, abs=0.05)
    middle = harmonic_load(centre - width, load, centre, width, terms)
    assert middle == pytest.approx(load * (0.5 - 2 * width), abs=1 / terms)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1.5, 0.5, 0.5, 0.2), "position: got 1.5, expected 0 to 1"),
        ((0.5, 1.5, 0.5, 0.2), "load: got 1.5, expected -1 to 1"),
        ((0.5, 0.5, -0.1, 0.2), "centre: got -0.1, expected 0 to 1"),
        ((0.5, 0.5, 0.5, math.nan), "half_width: got nan, expected 0 to 1"),
    ],
)
def test_3_17_names_its_bounds(arguments, message: str) -> None:
    for call in (
        lambda: harmonic_load(*arguments, 10),
        lambda: harmonic_limit(*arguments),
        lambda: harmonic_tail(*arguments, 10),
    ):
        with pytest.raises(InputError, match=message):
            call()
    for function in (harmonic_load, harmonic_tail):
        with pytest.raises(InputError, match="terms: got 0, expected 1 or more"):
            function(0.5, 0.5, 0.5, 0.2, 0)


@pytest.mark.parametrize("power", [2, 6])
@pytest.mark.parametrize("width", [0.1, 0.2, 0.4])
def test_3_18_at_chosen_points(power: int, width: float) -> None:
    """The points are the centre, the half width at 1 / e, half the height, and one far away."""
    load, centre, steepness = 0.744, 0.5, 2 / width
    at_half = math.log(2) ** (1 / power) / steepness
    for position, value in (
        (centre, load),
        (centre + width / 2, load / math.e),
        (centre - width / 2, load / math.e),
        (centre - at_half, load / 2),
        (centre + 4 * width, 0.0),
    ):
        found = power_load(position, load, centre, steepness, power)
        assert found == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize("power", [2, 4, 6, 50])
def test_3_18_has_the_area_of_the_gamma_function(power: int) -> None:
    x = np.linspace(-4, 4, 200_001)
    area = np.trapezoid(power_load(x, 0.9, 0.0, 5.0, power), x)
    assert area == pytest.approx(0.9 * 2 * math.gamma(1 + 1 / power) / 5, rel=1e-7)
