"""Tests the digit: beam, gauges and their places, the way to a code."""

from __future__ import annotations

import itertools
import math
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from shared import run

from golden.input_error import InputError
from studies.physics.digit_data import (
    COLUMNS,
    FARTHEST,
    RECORDED,
    SENSORS,
    digit_data,
    fit_sensor,
    fit_sensors,
    loads_from_codes,
    read_sensors,
)
from studies.physics.swing_data import Conditioning, ReflectiveSensor
from tactus.core.table import read_table
from tactus.physics.beam import Beam, StrainSensor, arm_slopes, mean_arm
from tactus.physics.gauges import MEAN_PER_DEVIATION, GaugeRig, Placing, load_rig
from tactus.report import gauges

BEAM = Beam()


def recorded() -> np.ndarray:
    return read_table(RECORDED, [*SENSORS, *COLUMNS])


@pytest.mark.parametrize("position", [0.0, 0.03, 0.09, 0.16])
@pytest.mark.parametrize("spread", [True, False])
def test_a_fit_finds_the_sensor_that_made_the_readings(position: float, spread: bool) -> None:
    loads = loads_from_codes(recorded()[:, 4:], BEAM)
    made = StrainSensor(2000.0, -0.02, position, BEAM)
    volts = made.read(
        loads if spread else replace(loads, half_width=np.zeros_like(loads.half_width))
    )
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


def test_the_command_writes_a_csv(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "studies.physics.digit_data", tmp_path / "d.csv"]
    result = run(*command, "--rows", "9", "--seed", "4")
    assert result.returncode == 0, result.stderr
    written = read_table(tmp_path / "d.csv", [*SENSORS, *COLUMNS])
    assert np.abs(written - digit_data(9, 4)).max() <= 5.1e-5


@given(st.floats(-0.1, 0.1), st.floats(1e-4, 0.05), st.booleans())
def test_the_mean_arm_is_the_integral_over_the_load(d: float, h: float, triangular: bool) -> None:
    def density(u: float) -> float:
        return (1 - abs(u) / h) / h if triangular else 1 / (2 * h)

    kinks = [0.0] if abs(d) >= h else sorted({0.0, -d})
    expected = quad(lambda u: density(u) * max(d + u, 0), -h, h, points=kinks, epsabs=1e-14)[0]
    assert mean_arm(d, h, triangular) == pytest.approx(expected, rel=1e-9, abs=1e-12)


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


@pytest.fixture(scope="module")
def rig() -> GaugeRig:
    return load_rig("digit")


def test_errors_are_those_of_readings_with_what_is_known_beforehand(rig: GaugeRig) -> None:
    """The reference is least squares on the readings and one prior reading of each unknown."""
    places = [0.05, 0.12, 0.16]
    found = Placing(rig).errors(places)
    for n in range(0, len(found), 37):
        rows, noise = [], []
        for place in places:
            unit = StrainSensor(1.0, 0.0, place, rig.beam)
            gain = rig.full_scale / np.abs(unit.read(rig.placements)).max()
            rows.append(gain * unit.slopes(rig.placements)[n])
            noise.append(math.hypot(rig.noise, gain * rig.noise_strain))
        rows.append(np.array([1 / rig.masses[1], 0, 0]))
        noise.append(rig.cell_noise)
        rows += list(np.eye(3))
        noise += list(rig.spreads)
        whitened = np.array(rows) / np.array(noise)[:, np.newaxis]
        deviations = np.linalg.norm(np.linalg.pinv(whitened), axis=1)
        expected = MEAN_PER_DEVIATION * deviations * rig.percent[n]
        assert found[n] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("objective", ["mean", "worst"])
def test_the_best_is_that_of_all_pairs(rig: GaugeRig, objective: str) -> None:
    few = replace(
        rig, count=2, span=(0.06, 0.16), objective=objective, outputs=("load", "position")
    )
    placing = Placing(few)
    pairs = [
        (placing.score(placing.errors_of(placing._all[list(pair)].sum(axis=0))), pair)
        for pair in itertools.combinations(range(0, len(placing.places), 2), 2)
        if placing.places[pair[1]] - placing.places[pair[0]] >= few.apart
    ]
    assert placing.score(placing.errors(placing.best())) <= min(score for score, _ in pairs)


def test_the_command_prints_and_writes(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr("sys.argv", ["make sensors", "digit", "--build", str(tmp_path)])
    gauges.main()
    printed = capsys.readouterr().out
    picture = (tmp_path / "sensors" / "digit" / "sensors.svg").read_text()
    for label in ("compared", "best found"):
        assert f">{label}</text>" in picture
        assert len(re.findall(rf"^{label} ", printed, re.M)) == 3
    rows = (tmp_path / "sensors" / "digit" / "sensors.csv").read_text().splitlines()
    assert len(rows) == 1 + 6


def rng() -> np.random.Generator:
    return np.random.default_rng(1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ReflectiveSensor(linear=0), "linear: got 0, expected 1e-06 to 1"),
        (lambda: ReflectiveSensor().read([np.nan], rng()), "deflection: got nan"),
        (lambda: Conditioning(1, cutoff=100), "cutoff: got 100, expected 0 to 99.8"),
        (lambda: Conditioning(1).amplify([np.inf], 0), "volts: got inf"),
    ],
)
def test_what_lies_outside_the_model_is_refused(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()
