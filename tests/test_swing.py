"""Tests the swing (Appendix 7, equations 6.4 and 6.5), the wobble, its rig and its recordings."""

import hashlib
import math
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from studies.physics.plate import Plate
from studies.physics.swing import (
    Swing,
    Wobble,
    bearing_forces,
    foot_forces,
    swing_motion,
)
from studies.physics.swing_data import (
    ANGLES,
    COLUMNS,
    Rig,
    independent_run,
    record,
    write_recordings,
)
from studies.stability.reference_swing import undamped_angle
from tactus.core.table import read_table
from tactus.physics.beam import GRAVITY

FREE = Swing(damping=0)


def test_the_rig_is_that_of_section_6_2_2() -> None:
    assert FREE.natural_frequency / (2 * math.pi) == pytest.approx(0.7, rel=0.03)
    assert math.degrees(2 * FREE.half_angle) == pytest.approx(49.25, abs=0.005)


def test_the_motion_comes_to_jacobis_closed_form() -> None:
    start = math.radians(50)
    motion = swing_motion(FREE, start, 3)
    assert np.abs(motion.angle - undamped_angle(FREE, start, motion.time)).max() < 1e-8


@pytest.mark.parametrize("rate", [0.1, 2.0, 30.0, 1e3])
def test_small_swings_are_a_damped_oscillator(rate: float) -> None:
    """The reference solves phi'' + rate phi' + omega^2 phi = 0, lightly and strongly damped."""
    swing, start = Swing(damping=rate * 0.48), 1e-4
    motion = swing_motion(swing, start, 3)
    root = np.sqrt(complex(rate**2 / 4 - swing.natural_frequency**2))
    fast, slow = -rate / 2 - root, -rate / 2 + root
    if slow.imag == 0:  # without the cancellation of two like numbers
        slow = swing.natural_frequency**2 / fast
    t = motion.time
    expected = (start * (slow * np.exp(fast * t) - fast * np.exp(slow * t)) / (slow - fast)).real
    assert np.abs(motion.angle - expected).max() < 1e-8 * start + 2e-12


@pytest.mark.parametrize("gyration", [0.0, 0.1])
def test_bearing_forces_are_what_accelerates_the_mass(gyration: float) -> None:
    """Newton's law is tested for the centre of mass, whose path is differentiated twice."""
    swing = Swing(damping=0, gyration=gyration)
    motion = swing_motion(swing, math.radians(40), 4, 2000)
    y, z = 0.48 * np.sin(motion.angle), -0.48 * np.cos(motion.angle)
    step = motion.time[1]
    ay, az = (np.diff(v, 2) / step**2 for v in (y, z))
    horizontal, downward = bearing_forces(swing, motion.angle, motion.speed)
    assert np.abs(horizontal[1:-1] + 10 * ay).max() < 1e-3
    assert np.abs(downward[1:-1] - 10 * (GRAVITY + az)).max() < 1e-3


@given(st.floats(-math.pi, math.pi), st.floats(-10, 10), st.floats(0, 50))
def test_foot_forces_balance_the_bearing_forces(angle: float, speed: float, frame: float) -> None:
    swing = Swing(frame_mass=frame)
    horizontal, downward = bearing_forces(swing, angle, speed)
    one, two = foot_forces(swing, angle, speed)
    assert one + two == pytest.approx(downward + frame * GRAVITY, abs=1e-9)
    # These are the moments about the middle between the feet.
    assert (two - one) * swing.feet / 2 == pytest.approx(horizontal * swing.height, abs=1e-9)


ROOT = Path(__file__).parents[1]
DATA = ROOT / "scenes" / "data"
STORY = tomllib.loads((DATA / "swing.toml").read_text(encoding="utf-8"))
NAMES = ("swing-train", *(f"swing-test-{n}" for n in range(1, 5)))


def shipped(name: str) -> np.ndarray:
    """The run that is shipped, or one of those that are made when they are needed."""
    if name == NAMES[0]:
        return read_table(DATA / f"{name}.csv", list(COLUMNS))
    return independent_run(NAMES.index(name), COLUMNS)


@pytest.mark.parametrize("name", NAMES)
def test_shipped_recordings_are_what_their_provenance_says(name: str) -> None:
    story = STORY[name]
    if name == NAMES[0]:
        assert hashlib.sha256((DATA / f"{name}.csv").read_bytes()).hexdigest() == story["sha256"]
    assert shipped(name).shape == (story["rows"], 6) == (5000, 6)
    assert story["clipped"] == 0


def test_shipped_recordings_can_be_made_again(tmp_path: Path) -> None:
    paths = write_recordings(tmp_path)
    assert [path.name for path in paths] == [*(f"{name}.csv" for name in NAMES), "swing.toml"]
    for path in paths[:-1]:
        again = read_table(path, list(COLUMNS))
        # Other versions of numpy and SciPy may round the last digit differently.
        assert np.abs(again - shipped(path.stem)).max() <= 1.3e-4
    again = tomllib.loads(paths[-1].read_text(encoding="utf-8"))
    assert again["offset_mm"] == pytest.approx(STORY["offset_mm"])
    assert again["mm_per_unit"] == pytest.approx(STORY["mm_per_unit"])
    assert [STORY[name]["angle_degrees"] for name in NAMES] == list(ANGLES)
    assert [STORY[name]["seed"] for name in NAMES] == [1, 2, 3, 4, 5]


def test_the_command(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "studies.physics.swing_data", str(tmp_path)]
    result = subprocess.run(
        [*command, "--angles", "20", "--seed", "9"], cwd=ROOT, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"swing-train.csv", "swing.toml"}
    result = subprocess.run([*command, "--angles", "80"], cwd=ROOT, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (2, "error: angle: got 80, expected -60 to 60\n")


PLATE = Plate()
A, B = PLATE.length, PLATE.width


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


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Swing(arm=1e-4), "arm: got 0.0001, expected 0.001 to 100"),
        (lambda: Swing(feet=1.44), "feet: got 1.44, expected 0.00072 to 1.43928"),
        (lambda: swing_motion(FREE, 4, 1), "start: got 4, expected -3.14159 to 3.14159"),
        (lambda: swing_motion(FREE, 1, 0), "seconds: got 0, expected 0.01 to 50000"),
        (lambda: undamped_angle(FREE, math.pi, 1), "start: got 3.14159, expected -3.1415"),
        (lambda: Wobble(ratio=0.6), "ratio: got 0.6, expected 0 to 0.5"),
        (lambda: record(90, 1), "angle: got 90, expected -60 to 60"),
        (lambda: record(60, 1), r"foot forces: got -.* N at .* s, expected 0 or more"),
        (lambda: write_recordings(Path(), angles=[]), "angles: got none, expected at least one"),
        (lambda: Rig(frames=0.6), "frames: got 0.6, expected 0.001 to 0.55"),
        (lambda: Rig(swing=Swing(feet=1.0)), "feet: got 1, expected 0 to 0.91"),
        (lambda: Plate(thickness=2), "thickness: got 2, expected 1e-06 to 1"),
        (lambda: Plate(1, 0.001), "length_over_width: got 1000, expected 0.01 to 100"),
        (lambda: PLATE.influence([[1, 0.2]], [[0, 0]]), "points x: got 1, expected 0 to 0.91"),
        (lambda: PLATE.influence([0, 0], [[0, 0]]), r"points: got shape \(2,\), expected \(n, 2\)"),
        (lambda: PLATE.influence([[0, 0]], [[0, 0]], 0), r"terms: got 0, expected 1 to 1e\+06"),
    ],
)
def test_what_lies_outside_the_model_is_refused(call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()
