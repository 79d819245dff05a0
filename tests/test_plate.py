"""Compares equations 6.1 to 6.3 of the plate with literature and finite differences."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import zeta

from golden.input_error import InputError
from tactus.physics.plate import Plate, _clamping, _supported
from tactus.physics.plate_grid import grid_influence, natural_frequency

PLATE = Plate()
A, B = PLATE.length, PLATE.width
PARTS = st.floats(0, 1)
PLACES = st.tuples(PARTS, PARTS)


def at(*parts: tuple[float, float], plate: Plate = PLATE) -> np.ndarray:
    """Places, which are given as parts of length and width."""
    return np.array(parts) * [plate.length, plate.width]


def centre(ratio: float, clamped: bool, terms: int = 5000) -> float:
    """w D / (P a^2) in the middle, with the load there, for b / a = ratio."""
    plate = Plate(1.0, ratio, clamped=clamped)
    middle = at((0.5, 0.5), plate=plate)
    return float(plate.influence(middle, middle, terms)[0, 0] * plate.stiffness)


@pytest.mark.parametrize(
    ("ratio", "alpha"),
    [
        (1.1, 0.01265),
        (1.2, 0.01353),
        (1.4, 0.01484),
        (1.6, 0.01570),
        (1.8, 0.01620),
        (2.0, 0.01651),
        (3.0, 0.01690),
    ],
)
def test_supported_plates_of_timoshenko_table_23(ratio: float, alpha: float) -> None:
    """They agree as well as the few terms allow, which were computed by hand."""
    assert centre(ratio, False) == pytest.approx(alpha, rel=2.5e-3)


def test_a_square_plate_is_the_closed_form_of_the_literature() -> None:
    assert centre(1, False) == pytest.approx(0.01160, abs=5e-6)


def test_long_strips() -> None:
    """A strip across x has a closed form. A strip clamped along both sides has 0.00725."""
    assert centre(100, False, 100_000) == pytest.approx(7 * zeta(3) / (16 * math.pi**3), rel=1e-9)
    assert centre(100, True, 100_000) == pytest.approx(7 * zeta(3) / (16 * math.pi**3), rel=1e-9)
    assert centre(0.02, True, 200_000) / 0.02**2 == pytest.approx(0.00725, abs=1e-5)


def printed_6_1(x: float, y: float, xi: float, eta: float, terms: int) -> float:
    """Equation 6.1 as printed, over D / P."""
    total = 0.0
    if y >= eta:
        y1 = B - y
    else:
        y1, eta = y, B - eta
    for m in range(1, terms + 1):
        beta = m * math.pi * B / A
        u, v = beta * y1 / B, beta * eta / B
        bracket = 1 + beta / math.tanh(beta) - u / math.tanh(u) - v / math.tanh(v)
        sines = math.sin(m * math.pi * xi / A) * math.sin(m * math.pi * x / A)
        total += bracket * math.sinh(v) * math.sinh(u) * sines / (m**3 * math.sinh(beta))
    return A**2 / math.pi**3 * total


def printed_6_3(x: float, xi: float, off: float, terms: int, clamped: bool) -> float:
    """Equation 6.3 or 6.2 as printed, over D / P; the load is on the axis, the point off it."""
    first = second = 0.0
    for m in range(1, terms + 1):
        alpha = m * math.pi * B / (2 * A)
        u = alpha / B * (B - 2 * off)
        sines = math.sin(m * math.pi * xi / A) * math.sin(m * math.pi * x / A)
        bracket = (1 + alpha * math.tanh(alpha)) * math.sinh(u) - u * math.cosh(u)
        first += bracket * sines / (m**3 * math.cosh(alpha))
        both = math.sinh(alpha) * math.cosh(alpha) + alpha
        second += sines * math.tanh(alpha) ** 2 / (m * both)
    correction = math.pi**2 / 4 * second if clamped else 0
    return B**2 / (2 * math.pi**3) * (A**2 / B**2 * first - correction)


@pytest.mark.parametrize("y", [0.1, 0.3, 0.5])
def test_equation_6_1_as_printed(y: float) -> None:
    plate = replace(PLATE, clamped=False)
    found = plate.influence([[0.32, y]], [[0.5, 0.2]], 30)[0, 0] * plate.stiffness
    assert found == pytest.approx(printed_6_1(0.32, y, 0.5, 0.2, 30), rel=1e-11)


@pytest.mark.parametrize("off", [0.0, 0.1, 0.27])
def test_equation_6_2_as_printed(off: float) -> None:
    """The argument is alpha (b - 2 y) / b, for which the thesis prints the factor 1 / b."""
    plate = replace(PLATE, clamped=False)
    found = plate.influence([[0.32, B / 2 + off]], [[0.5, B / 2]], 30)[0, 0] * plate.stiffness
    assert found == pytest.approx(printed_6_3(0.32, 0.5, off, 30, False), rel=1e-11)


def test_equation_6_3_as_printed_holds_on_the_axis_alone() -> None:
    on = PLATE.influence([[0.32, B / 2]], [[0.5, B / 2]], 30)[0, 0] * PLATE.stiffness
    assert on == pytest.approx(printed_6_3(0.32, 0.5, 0, 30, True), rel=1e-11)
    off = PLATE.influence([[0.32, 0.95 * B]], [[0.5, B / 2]], 30)[0, 0] * PLATE.stiffness
    printed = printed_6_3(0.32, 0.5, 0.45 * B, 30, True)
    assert off > 0 > printed


@pytest.mark.parametrize("clamped", [True, False])
@pytest.mark.parametrize("load", [(0.5, 0.5), (0.25, 0.25), (0.75, 0.125)])
def test_finite_differences_come_to_the_series(clamped: bool, load: tuple) -> None:
    """They agree everywhere on the plate, and three times better with cells of half the size."""
    plate = replace(PLATE, clamped=clamped)
    errors = []
    for cells in (24, 48):
        x = np.arange(1, cells) / cells
        nodes = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2) * [A, B]
        series = plate.influence(nodes, at(load), 300).reshape(cells - 1, cells - 1)
        grid = grid_influence(plate, at(load)[0], cells, cells)
        errors.append(np.abs(grid - series).max() / series.max())
    assert errors[1] < 0.05
    assert 2.6 < errors[0] / errors[1] < 4.2


@pytest.mark.parametrize("clamped", [True, False])
def test_edges_do_not_move_and_clamped_ones_do_not_turn(clamped: bool) -> None:
    """From a clamped edge the deflection grows with the square of the distance."""
    plate = replace(PLATE, clamped=clamped)
    load = at((0.4, 0.3))
    edges = at((0, 0.5), (1, 0.5), (0.3, 0), (0.3, 1), (0, 0), (1, 1))
    assert np.abs(plate.influence(edges, load)).max() < 1e-20
    for x, y, inward in ((0.3, 0, 1), (0.3, 1, -1)):
        near, twice = (
            plate.influence([[x * A, y * B + inward * step]], load)[0, 0] for step in (1e-5, 2e-5)
        )
        assert near > 0
        assert twice / near == pytest.approx(4 if clamped else 2, rel=1e-3)


@given(PLACES, PLACES, st.booleans())
def test_what_a_load_does_elsewhere_it_suffers_from_there(p: tuple, q: tuple, clamped: bool):
    plate = replace(PLATE, clamped=clamped)
    both = plate.influence(at(p, q), at(p, q), 100)
    assert both[0, 1] == pytest.approx(both[1, 0], rel=1e-9, abs=1e-17)


@given(PLACES, PLACES, st.integers(1, 300), st.booleans(), st.floats(0.05, 20))
def test_the_tail_bounds_what_is_left_out(
    p: tuple, q: tuple, terms: int, clamped: bool, ratio: float
) -> None:
    plate = Plate(1.0, ratio, clamped=clamped)
    point, load = at(p, plate=plate), at(q, plate=plate)
    miss = abs(plate.influence(point, load, terms) - plate.influence(point, load, 3000))[0, 0]
    # Rounding adds a few units in the last place of the largest deflection.
    assert miss <= plate.tail(point, load, terms)[0, 0] + 1e-13 / plate.stiffness


def test_the_bound_is_near_what_it_bounds_at_the_load() -> None:
    middle = at((0.5, 0.5))
    for terms in (10, 1000):
        miss = (PLATE.influence(middle, middle, 300_000) - PLATE.influence(middle, middle, terms))[
            0, 0
        ]
        assert 0.4 < miss / PLATE.tail(middle, middle, terms)[0, 0] <= 1


def test_the_tail_at_the_load_is_the_sum_of_what_each_term_can_be() -> None:
    """With one more term than N it falls by (a^2 / (2 pi^3 P)) / (N + 1)^3."""
    middle = at((0.5, 0.5))
    for terms in (1, 7, 50):
        fall = (PLATE.tail(middle, middle, terms) - PLATE.tail(middle, middle, terms + 1))[0, 0]
        expected = A**2 / (2 * math.pi**3 * PLATE.stiffness) / (terms + 1) ** 3
        assert fall == pytest.approx(expected, rel=1e-9)


def test_nothing_overflows_for_a_million_terms() -> None:
    places = at((0.5, 0.5), (0.5, 0.4), (0, 0), (1, 1), (0.3, 1e-9))
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        found = PLATE.influence(places, places, 1_000_000)
    assert np.isfinite(found).all()
    assert found[0, 0] == found.max()


@pytest.mark.skipif(
    np.finfo(np.longdouble).eps > 1e-18, reason="no wider float than float64 to compare with"
)
@pytest.mark.parametrize(("ratio", "bound"), [(0.01, 1e-9), (1.0, 1e-13), (100.0, 1e-13)])
def test_rounding_of_every_term(ratio: float, bound: float) -> None:
    """The reference has 64 bits of mantissa. A narrow plate cancels, as the docstring says."""
    m = np.arange(1, 2000).reshape(-1, 1, 1)
    y, eta = (
        np.linspace(0.05, 0.95, 7).reshape(1, -1, 1),
        np.linspace(0.1, 0.9, 5).reshape(1, 1, -1),
    )

    def line(kind: type) -> np.ndarray:
        k = kind(1) * m * kind(np.pi) * kind(ratio)
        near, far = np.minimum(y, eta), np.maximum(y, eta)
        one = kind(1)
        supported = _supported(k, k * (near * one), k * (1 - far * one))
        middle = _clamping(k / 2, k * (y - one / 2), k * (eta * one), k * (1 - eta * one))
        return supported - middle

    wide, narrow = line(np.longdouble), line(np.float64)
    scale = np.abs(wide).max(axis=(1, 2), keepdims=True)
    assert np.abs((narrow - wide) / scale)[m.ravel() * ratio < 200].max() < bound


def test_stiffness_and_the_order_of_size() -> None:
    """10 kg in the middle of the rig give half a millimetre, well below the thickness."""
    assert pytest.approx(2e11 * 0.0028**3 / (12 * 0.91), rel=1e-12) == PLATE.stiffness
    middle = at((0.5, 0.5))
    assert 98.0665 * PLATE.influence(middle, middle)[0, 0] == pytest.approx(0.536e-3, rel=0.01)


def test_the_natural_frequency_is_that_of_section_6_1() -> None:
    """The thesis prints 53 Hz.

    The 0.7 Hz of the swing are far below, so its forces act statically.
    """
    assert natural_frequency(PLATE, 7850, 40, 40) == pytest.approx(53, rel=0.05)
    supported = replace(PLATE, clamped=False)
    mass = 7850 * PLATE.thickness
    exact = math.pi / 2 * (1 / A**2 + 1 / B**2) * math.sqrt(PLATE.stiffness / mass)
    assert natural_frequency(supported, 7850, 40, 40) == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Plate(thickness=2), "thickness: got 2, expected 1e-06 to 1"),
        (lambda: Plate(1, 0.001), "length_over_width: got 1000, expected 0.01 to 100"),
        (lambda: Plate(poisson=0.6), "poisson: got 0.6, expected 0 to 0.5"),
        (lambda: PLATE.influence([[1, 0.2]], [[0, 0]]), "points x: got 1, expected 0 to 0.91"),
        (
            lambda: PLATE.influence([[0, 0]], [[0.1, np.nan]]),
            "loads y: got nan, expected 0 to 0.55",
        ),
        (lambda: PLATE.influence([0, 0], [[0, 0]]), r"points: got shape \(2,\), expected \(n, 2\)"),
        (lambda: PLATE.influence([[0, 0]], [[0, 0]], 0), r"terms: got 0, expected 1 to 1e\+06"),
        (lambda: PLATE.tail([[0, 0]], [[0, 0]], 0), "terms: got 0"),
        (lambda: grid_influence(PLATE, [0, 0], 3, 9), "columns: got 3, expected 4 to 2000"),
        (lambda: grid_influence(PLATE, [2, 0], 9, 9), "load_x: got 2, expected 0 to 0.91"),
        (lambda: natural_frequency(PLATE, 0, 9, 9), r"density: got 0, expected 1 to 100000"),
    ],
)
def test_what_lies_outside_the_model_is_refused(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()
