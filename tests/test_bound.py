"""Tests the bound of Cramer and Rao for a load, and what prior knowledge adds."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from golden.numbers.units import FULL_SCALE
from tactus.core.table import read_table
from tactus.physics.beam import Beam, arm_slopes, mean_arm
from tactus.physics.bound import (
    MEAN_PER_DEVIATION,
    least_deviations,
    slopes_by_codes,
)
from tactus.physics.digit_data import RECORDED, SENSORS
from tactus.physics.known_loads import least_errors
from tactus.physics.strain_sensor import COLUMNS, fit_sensors, loads_from_codes, read_sensors
from tactus.scene.metrics import error_scale

TABLE = read_table(RECORDED, [*SENSORS, *COLUMNS])
TARGETS = TABLE[:, len(SENSORS) :]
BEAM = Beam()
SENSORS_FITTED = fit_sensors(TABLE, BEAM)
SCALE = error_scale(TARGETS, COLUMNS, {"position": FULL_SCALE, "width": FULL_SCALE})
NOISE = np.full(len(SENSORS), 0.002)
# Load A covers sensor 3 here, a quarter of the width away from its middle.
WITHIN = np.array([0.9, 0.63, 0.9, 0.45])


def readings(codes: np.ndarray) -> np.ndarray:
    return read_sensors(SENSORS_FITTED, loads_from_codes(codes, BEAM))


@pytest.mark.parametrize("triangular", [False, True])
def test_slopes_of_the_arm_are_its_finite_differences(triangular: bool) -> None:
    # The middle and the ends of the load are avoided, because the second derivative jumps there.
    d, h, e = np.linspace(-0.0301, 0.0303, 61), 0.02, 1e-7
    by_distance, by_half_width = arm_slopes(d, h, triangular)
    moved = (mean_arm(d + e, h, triangular) - mean_arm(d - e, h, triangular)) / (2 * e)
    wider = (mean_arm(d, h + e, triangular) - mean_arm(d, h - e, triangular)) / (2 * e)
    assert by_distance == pytest.approx(moved, abs=1e-4)
    assert by_half_width == pytest.approx(wider, abs=1e-4)
    assert (by_half_width[np.abs(d) > h] == 0).all()
    assert by_half_width.max() == pytest.approx(1 / 6 if triangular else 1 / 4, abs=1e-3)


def test_slopes_of_the_readings_are_their_finite_differences() -> None:
    slopes, e = slopes_by_codes(SENSORS_FITTED, TARGETS), 1e-6
    assert slopes.shape == (143, 4, 3)
    for k in range(3):
        step = e * np.eye(4)[k]
        expected = (readings(TARGETS + step) - readings(TARGETS - step)) / (2 * e)
        assert slopes[:, :, k] == pytest.approx(expected, abs=1e-8)


def test_the_bound_is_the_inverse_of_the_information() -> None:
    rng = np.random.default_rng(1)
    slopes, noise = rng.normal(size=(20, 5, 3)), rng.uniform(0.5, 2, 5)
    whitened = slopes / noise[:, np.newaxis]
    information = whitened.swapaxes(-1, -2) @ whitened
    expected = np.sqrt(np.diagonal(np.linalg.inv(information), axis1=-2, axis2=-1))
    assert least_deviations(slopes, noise) == pytest.approx(expected, rel=1e-9)
    assert least_deviations(slopes, 2.0) == pytest.approx(2 * least_deviations(slopes, 1.0))


def test_what_no_reading_holds_has_no_bound_and_leaves_the_others_theirs() -> None:
    absent = np.array([[1.0, 0, 0], [0, 1, 0], [0, 1, 0]])
    assert least_deviations(absent, 1.0) == pytest.approx([1, 1 / np.sqrt(2), np.inf])
    # Two parameters that change the readings alike, in different units, cannot be distinguished.
    alike = np.outer([0.1, 0.7, 0.3, 0.2], [0, 1, 3e-6]) + np.outer([0.9, -0.1, 0, -0.1], [1, 0, 0])
    assert least_deviations(alike, 1.0) == pytest.approx([1 / np.sqrt(0.83), np.inf, np.inf])


def test_least_squares_reach_the_bound() -> None:
    """Least squares is an efficient estimator, so its deviation over many draws is the bound.

    Its mean error is sqrt(2 / pi) of the bound. With 600 draws the deviation is known to 3 %.
    """
    noise, rng = 2e-4, np.random.default_rng(1)
    exact = readings(WITHIN[np.newaxis])[0]

    def miss(codes: np.ndarray, seen: np.ndarray) -> np.ndarray:
        return readings(np.append(codes, WITHIN[3])[np.newaxis])[0] - seen

    found = np.array(
        [
            least_squares(miss, WITHIN[:3], args=(exact + noise * rng.standard_normal(4),)).x
            for _ in range(600)
        ]
    )
    bound = least_deviations(slopes_by_codes(SENSORS_FITTED, WITHIN[np.newaxis]), noise)[0]
    assert found.std(axis=0) == pytest.approx(bound, rel=0.1)
    assert np.abs(found - WITHIN[:3]).mean(axis=0) == pytest.approx(
        MEAN_PER_DEVIATION * bound, rel=0.1
    )


@pytest.fixture(scope="module")
def known() -> dict[bool, np.ndarray]:
    rng = np.random.default_rng(1)
    return {
        which: least_errors(SENSORS_FITTED, TARGETS, NOISE, SCALE, which, 10, rng)
        for which in (False, True)
    }
