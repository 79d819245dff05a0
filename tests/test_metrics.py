"""Compares the error measures with closed forms, recorded vectors and tables of the thesis."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from golden.activation.gradient import gradient_for
from golden.input_error import InputError
from golden.numbers.precision import SIGNAL, THESIS
from golden.numbers.units import FULL_SCALE, LOAD_G, POSITION_MM, WIDTH_MM
from tactus.core.table import read_table
from tactus.scene.metrics import (
    OutputError,
    activation_error,
    displacement_errors,
    millimetres,
)

DATA = Path(__file__).parents[1] / "scenes" / "data"
BEAM = tomllib.loads((DATA / "thesis_numbers.toml").read_text())["beam"]


def recorded(*columns: str) -> np.ndarray:
    return read_table(DATA / "appendix2.csv", columns)


def test_the_positions_are_a_load_step_apart() -> None:
    load, position = recorded("load", "position").T
    for weight in np.unique(load):
        steps = np.diff(position[load == weight]) / FULL_SCALE * POSITION_MM
        assert np.allclose(steps, BEAM["load_step_mm"], atol=1e-9)


def test_the_first_placement_moves_by_half_of_the_extra_width() -> None:
    """Position and width are coded with the same scale of millimetres."""
    load, position, width = recorded("load", "position", "width").T
    first = [position[load == weight].min() for weight in np.unique(load)]
    widths = [width[load == weight][0] for weight in np.unique(load)]
    left = np.array(first) * POSITION_MM - np.array(widths) * WIDTH_MM / 2
    assert np.allclose(left / FULL_SCALE, BEAM["load_step_mm"], atol=1e-9)


def test_the_codes_of_table_3_1() -> None:
    load, width = (np.unique(column) for column in recorded("load", "width").T)
    assert np.allclose(width / FULL_SCALE * WIDTH_MM, [12.7, 25.4, 38.1, 50.8])
    assert np.allclose(load / FULL_SCALE * LOAD_G, [6, 8, 9, 11, 12, 16, 19, 23], atol=0.01)


def test_the_placements_lie_on_the_beam() -> None:
    furthest = recorded("position").max() / FULL_SCALE * POSITION_MM
    assert furthest <= BEAM["working_range_fraction_from_tip"] * BEAM["length_mm"]


def test_percent_of_a_full_scale_in_millimetres() -> None:
    found = millimetres(OutputError(mean=5.0, largest_mean=10.0, worst=100.0), POSITION_MM)
    assert (found.mean, found.largest_mean, found.worst) == pytest.approx((6.35, 12.7, 127.0))
    for length in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InputError, match=r"length: got .* expected millimetres above 0"):
            millimetres(OutputError(1, 1, 1), length)


def test_displacement_errors_of_a_sine() -> None:
    """The distance from end to end of a sine is twice its amplitude."""
    t = (np.arange(100_000) + 0.5) / 100_000
    actual = np.stack([np.sin(2 * np.pi * t), 300 * np.cos(4 * np.pi * t)], axis=1)
    found = displacement_errors(actual + np.array([0.01, -6.0]), actual)
    assert [e.mean for e in found] == pytest.approx([0.01, 6.0])
    assert [e.displacement for e in found] == pytest.approx([2, 600], rel=1e-6)
    assert [e.percent for e in found] == pytest.approx([0.5, 1], rel=1e-6)


@pytest.mark.parametrize("points", [7, 600, 100_001])
def test_activation_error_of_known_integrals(points: int) -> None:
    q = np.linspace(-3, 3, points)
    constant = activation_error(np.full(points, -0.01), q)
    assert constant.mean_percent == pytest.approx(1.0)
    assert constant.mean_percent_thesis == pytest.approx(2.0)
    assert constant.largest == pytest.approx(81.92)
    # The integral of |q| over [-3, 3] is 9. Trapezoids give it exactly if 0 is on the grid.
    assert activation_error(q, q).mean_percent == pytest.approx(150, rel=9 / points**2)


def test_activation_error_of_the_gradient_scheme_is_the_printed_one() -> None:
    """Section 4.6 prints 0.40 %. The last code of Fix(14,13) at Q = 3 stands for 3 - 3 / 2**13."""
    codes = np.arange(SIGNAL.low, SIGNAL.high + 1)
    q = 3 * SIGNAL.to_real(codes)
    errors = SIGNAL.to_real(gradient_for(THESIS, 3, SIGNAL.high).process(codes)) - np.tanh(q)
    found = activation_error(errors, q)
    assert found.mean_percent_thesis == pytest.approx(0.40, abs=0.02)
    assert 131 < found.largest < 133
