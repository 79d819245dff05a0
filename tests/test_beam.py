"""Tests the cantilever and its gauges: equations 3.1 to 3.5 and 3.7 to 3.9, and generated data."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from golden.input_error import InputError
from tactus.core.table import read_table
from tactus.physics import GRAVITY
from tactus.physics.beam import Beam, mean_arm
from tactus.physics.digit_data import RECORDED, SENSORS, digit_data
from tactus.physics.strain_sensor import (
    COLUMNS,
    FARTHEST,
    Loads,
    StrainSensor,
    fit_sensor,
    fit_sensors,
    loads_from_codes,
    read_sensors,
)

ROOT = Path(__file__).parents[1]
BEAM = Beam()
ALONG = np.linspace(0, BEAM.length, 1001)


def recorded() -> np.ndarray:
    return read_table(RECORDED, [*SENSORS, *COLUMNS])


def test_a_load_at_the_tip_is_equation_3_2() -> None:
    """E I = 2e11 12.7e-3 (0.4e-3)^3 / 12 by hand."""
    stiffness = 0.013546666666666667
    assert pytest.approx(stiffness, rel=1e-12) == BEAM.stiffness
    expected = -0.023 * GRAVITY * 0.2286**3 / (3 * stiffness)
    assert BEAM.deflection(BEAM.length, 0.023, BEAM.length) == pytest.approx(expected, rel=1e-12)


def test_both_cases_of_equations_3_1_and_3_3_as_printed() -> None:
    force, a, stiffness = 0.013 * GRAVITY, 0.1, BEAM.stiffness
    i, beyond = 0.04, 0.2
    assert BEAM.deflection([i, beyond], 0.013, a) == pytest.approx(
        [
            -force * i**2 / (6 * stiffness) * (3 * a - i),
            -force * a**2 / (6 * stiffness) * (3 * beyond - a),
        ]
    )
    assert BEAM.slope([i, beyond], 0.013, a) == pytest.approx(
        [-force * i / (2 * stiffness) * (2 * a - i), -force * a**2 / (2 * stiffness)]
    )


@pytest.mark.parametrize("position", [0.05, 0.1, 0.2286])
def test_slope_and_moment_are_derivatives_of_the_deflection(position: float) -> None:
    v = BEAM.deflection(ALONG, 0.023, position)
    slope = np.gradient(v, ALONG, edge_order=2)
    assert np.allclose(slope, BEAM.slope(ALONG, 0.023, position), atol=1e-6)
    moment = np.gradient(BEAM.slope(ALONG, 0.023, position), ALONG) * BEAM.stiffness
    inside = np.abs(ALONG - position) > 2 * ALONG[1]
    inside[[0, -1]] = False
    assert np.allclose(moment[inside], BEAM.moment(ALONG, 0.023, position)[inside], atol=1e-9)


def test_the_strain_is_the_typical_maximum_of_section_3_5() -> None:
    """With 23 g at the tip, the strain at the root is near 1e-3 and below it."""
    moment = BEAM.moment(0, 0.023, BEAM.length)
    strain = abs(moment) * BEAM.thickness / (2 * BEAM.stiffness)
    assert 7e-4 < strain < 1e-3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.3, 0.01, 0.1), r"at: got 0.3, expected 0 to 0.2286"),
        ((0.1, -1, 0.1), r"mass: got -1, expected 0 to 1e\+06"),
        ((0.1, 0.01, float("nan")), r"position: got nan, expected 0 to 0.2286"),
    ],
)
def test_places_off_the_beam_are_refused(arguments: tuple, message: str) -> None:
    for method in (BEAM.deflection, BEAM.slope, BEAM.moment):
        with pytest.raises(InputError, match=message):
            method(*arguments)


def test_a_sensor_reads_equation_3_9() -> None:
    # An amplifier of 200, a gauge factor of 2.1, and 5 V on a half bridge.
    sensor = StrainSensor(200 * 2.1 * 5 / 2, 0.1, 0.05, BEAM)
    loads = Loads(np.array([0.02]), np.array([0.15]), np.zeros(1), np.zeros(1))
    moment = BEAM.moment(0.05, 0.02, 0.15)
    expected = 200 / 2 * 2.1 * 0.0002 * moment / BEAM.stiffness * 5 + 0.1
    assert sensor.read(loads) == pytest.approx([expected])
    with pytest.raises(InputError, match=r"position: got 0.3, expected 0 to 0.2286"):
        sensor.read(Loads(np.array([0.02]), np.array([0.3]), np.zeros(1), np.zeros(1)))


@pytest.mark.parametrize("position", [0.0, 0.03, 0.09, 0.16])
@pytest.mark.parametrize("spread", [True, False])
def test_a_fit_finds_the_sensor_that_made_the_readings(position: float, spread: bool) -> None:
    loads = loads_from_codes(recorded()[:, 4:], BEAM)
    made = StrainSensor(2000.0, -0.02, position, BEAM)
    volts = made.read(loads if spread else loads.at_points())
    found = fit_sensor(volts, loads, BEAM, spread)
    assert found.gain == pytest.approx(2000, rel=1e-4)
    assert found.offset == pytest.approx(-0.02, abs=1e-5)
    assert found.position == pytest.approx(position, abs=1e-5)


def test_what_the_fit_makes_of_the_recorded_sensors() -> None:
    """Sensors 1 to 3 follow theory within 2.4 % of their span; sensor 4 reads no bending moment."""
    table = recorded()
    loads = loads_from_codes(table[:, 4:], BEAM)
    sensors = fit_sensors(table, BEAM)
    residuals = read_sensors(sensors, loads) - table[:, :4]
    percent = 100 * np.sqrt((residuals**2).mean(axis=0)) / np.ptp(table[:, :4], axis=0)
    assert percent == pytest.approx([0.75, 1.09, 2.11, 1.12], abs=0.01)
    places = [1e3 * sensor.position for sensor in sensors[:3]]
    assert places == pytest.approx([0.5, 86.9, 149.9], abs=0.1)
    assert sensors[3].position == pytest.approx(BEAM.length * (1 - FARTHEST), rel=1e-3)
    # The load alone fits as well as any position of the sensor.
    matrix = np.stack([loads.mass, np.ones(len(table))], axis=1)
    volts_per_kg = np.linalg.lstsq(matrix, table[:, 3])[0]
    alone = np.sqrt(((matrix @ volts_per_kg - table[:, 3]) ** 2).mean())
    assert alone <= np.sqrt((residuals[:, 3] ** 2).mean())
    assert volts_per_kg == pytest.approx([38.56, 0.0071], abs=0.01)


def test_every_other_row_of_sensors_1_to_3_was_interpolated() -> None:
    """They are the mean of two placements 12.7 mm apart, and sensor 4 is not."""
    table = recorded()
    means = []
    for load in np.unique(table[:, 4]):
        rows = table[table[:, 4] == load][:, :4]
        between = rows[1:-1:2] - (rows[:-2:2] + rows[2::2]) / 2
        means.append(np.abs(between) < 6e-5)
    assert np.concatenate(means).sum(axis=0).tolist() == [66, 66, 66, 6]


@pytest.mark.parametrize(
    ("readings", "message"),
    [
        (np.zeros(3), r"readings: got shape \(3,\), expected \(n,\) with n of 4 or more"),
        (np.full(143, np.nan), "readings: got nan"),
        (np.zeros(20), r"loads: got shape \(143,\), expected \(20,\)"),
    ],
)
def test_readings_that_cannot_be_fitted_are_refused(readings, message: str) -> None:
    with pytest.raises(InputError, match=message):
        fit_sensor(readings, loads_from_codes(recorded()[:, 4:], BEAM), BEAM)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((0, 1), "rows: got 0"), ((5, -1), "seed: got -1"), ((5, 1, -0.1), "noise: got -0.1")],
)
def test_digit_data_refuses_what_it_cannot_make(arguments: tuple, message: str) -> None:
    with pytest.raises(InputError, match=message):
        digit_data(*arguments)


def test_the_command_writes_a_csv(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tactus.physics.digit_data", str(tmp_path / "d.csv")]
    result = subprocess.run(
        [*command, "--rows", "9", "--seed", "4"], cwd=ROOT, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stderr
    written = read_table(tmp_path / "d.csv", [*SENSORS, *COLUMNS])
    assert np.abs(written - digit_data(9, 4)).max() <= 5.1e-5
    result = subprocess.run([*command, "--rows", "0"], cwd=ROOT, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (
        2,
        "error: rows: got 0, expected 1 to 1e+06\n",
    )


@given(st.floats(-0.1, 0.1), st.floats(1e-4, 0.05), st.booleans())
def test_the_mean_arm_is_the_integral_over_the_load(d: float, h: float, triangular: bool) -> None:
    def density(u: float) -> float:
        return (1 - abs(u) / h) / h if triangular else 1 / (2 * h)

    kinks = [0.0] if abs(d) >= h else sorted({0.0, -d})
    expected = quad(lambda u: density(u) * max(d + u, 0), -h, h, points=kinks, epsabs=1e-14)[0]
    assert mean_arm(d, h, triangular) == pytest.approx(expected, rel=1e-9, abs=1e-12)
