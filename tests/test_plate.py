"""Compares equations 6.1 to 6.3 of the plate with literature and finite differences."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.linalg import eigsh, spsolve

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.physics.plate import Plate

PLATE = Plate()
A, B = PLATE.length, PLATE.width


def biharmonic(plate: Plate, columns: int, rows: int) -> sparse.csc_array:
    """The operator of the plate equation, over the stiffness, at the inner nodes (row by row)."""

    def second(cells: int, length: float) -> sparse.dia_array:
        ones = np.ones(cells - 1)
        bands = (ones, -2 * ones, ones)
        return sparse.dia_array((np.stack(bands), (-1, 0, 1)), shape=(cells - 1, cells - 1)) * (
            (cells / length) ** 2
        )

    x, y = second(columns, plate.length), second(rows, plate.width)
    fourth = (y @ y).tolil()
    if plate.clamped:
        # A mirrored node beyond a clamped edge has the deflection of its image; at a simply
        # supported edge it has the negative of it. So the mirror adds 1 + 1 instead of -1 + 1.
        for end in (0, rows - 2):
            fourth[end, end] += 2 * (rows / plate.width) ** 4
    identity_x = sparse.eye_array(columns - 1)
    identity_y = sparse.eye_array(rows - 1)
    return sparse.csc_array(
        sparse.kron(identity_y, x @ x) + 2 * sparse.kron(y, x) + sparse.kron(fourth, identity_x)
    )


def grid_influence(plate: Plate, load: ArrayLike, columns: int, rows: int) -> Real:
    """Deflection of all inner nodes for 1 N at one node, m/N.

    It uses the thirteen-point stencil of the plate equation, which is of second order. At the load,
    where the curvature has no limit, the error is of second order except for a logarithm.

    load, shape (2,): xi and eta in m; the load acts at the nearest inner node.
    columns, rows: Cells along x and y.

    Returns, shape (rows - 1, columns - 1): Node (i, j) is at y = (i + 1) b / rows, x = (j + 1) a /
        columns.
    """
    operator = biharmonic(plate, columns, rows)
    xi, eta = np.asarray(load, dtype=np.float64)
    j = int(np.clip(round(xi / plate.length * columns), 1, columns - 1)) - 1
    i = int(np.clip(round(eta / plate.width * rows), 1, rows - 1)) - 1
    pressure = np.zeros((rows - 1, columns - 1))
    pressure[i, j] = columns * rows / (plate.length * plate.width * plate.stiffness)
    result: Real = spsolve(operator, pressure.ravel()).reshape(pressure.shape)
    return result


def natural_frequency(plate: Plate, density: float, columns: int, rows: int) -> float:
    """Lowest natural frequency in Hz; the error is of second order in the size of the cells.

    density: kg/m^3; that of steel is 7850.
    columns, rows: Cells along x and y.
    """
    lowest = eigsh(
        biharmonic(plate, columns, rows), k=1, sigma=0, which="LM", return_eigenvectors=False
    )
    stiffness_over_mass = plate.stiffness / (density * plate.thickness)
    return float(np.sqrt(lowest[0] * stiffness_over_mass) / (2 * np.pi))


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
    ],
)
def test_what_lies_outside_the_model_is_refused(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()
