"""Tests the swing (Appendix 7, equations 6.4 and 6.5), the wobble, its rig and its recordings."""

import hashlib
import math
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import find_peaks

from golden.input_error import InputError
from studies.stability.reference_swing import undamped_angle
from tactus.core.table import read_table
from tactus.physics import GRAVITY
from tactus.physics.plate import Plate
from tactus.physics.swing import (
    METHODS,
    Motion,
    Swing,
    Wobble,
    bearing_forces,
    foot_forces,
    swing_motion,
)
from tactus.physics.swing_data import (
    ANGLES,
    BOUND,
    COLUMNS,
    LEAST_WOBBLE,
    Rig,
    independent_run,
    record,
    write_recordings,
)

FREE = Swing(damping=0)
PERIOD = 2 * math.pi / FREE.natural_frequency
# From larger start angles, the force of a foot has twin peaks. The limit follows from
# d N_y2 / d phi = 0 at the start: 3 k T^2 + 4 T - k = 0 with T = tan(start), k = 1 / tan(psi).
COT = 1 / math.tan(FREE.half_angle)
TWIN = math.atan((-4 + math.sqrt(16 + 12 * COT**2)) / (6 * COT))


def swung(degrees: float, swing: Swing = FREE, seconds: float = 4, rate: float = 1000) -> Motion:
    return swing_motion(swing, math.radians(degrees), seconds, rate)


def test_the_rig_is_that_of_section_6_2_2() -> None:
    assert FREE.natural_frequency / (2 * math.pi) == pytest.approx(0.7, rel=0.03)
    assert math.degrees(2 * FREE.half_angle) == pytest.approx(49.25, abs=0.005)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_comes_to_jacobis_closed_form(method: str) -> None:
    start = math.radians(50)
    motion = swing_motion(FREE, start, 3, method=method, tolerance=1e-6)
    assert np.abs(motion.angle - undamped_angle(FREE, start, motion.time)).max() < 1e-4


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
    motion = swung(40, swing, rate=2000)
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


def twin_peaks(degrees: float, force: int = 1) -> bool:
    """Whether a force has two peaks per period: of foot 0 or 1, or F_x for 2."""
    motion = swung(degrees, seconds=4 * PERIOD)
    if force == 2:
        values = bearing_forces(FREE, motion.angle, motion.speed)[0]
    else:
        values = foot_forces(FREE, motion.angle, motion.speed)[force]
    return len(find_peaks(values)[0]) > 6


def test_twin_peaks_above_and_from_what_angle_on() -> None:
    """The limit is 19.2 degrees for the feet of the rig, and 30 degrees for F_x of any rig."""
    assert math.degrees(TWIN) == pytest.approx(19.17, abs=0.01)
    assert twin_peaks(30)
    for foot in (0, 1):
        assert twin_peaks(math.degrees(TWIN) + 1, foot)
        assert not twin_peaks(math.degrees(TWIN) - 1, foot)
    assert twin_peaks(31.5, 2)
    assert not twin_peaks(28.5, 2)


ROOT = Path(__file__).parents[1]
DATA = ROOT / "scenes" / "data"
STORY = tomllib.loads((DATA / "swing.toml").read_text(encoding="utf-8"))
NAMES = ("swing-train", *(f"swing-test-{n}" for n in range(1, 5)))


def shipped(name: str) -> np.ndarray:
    """The run that is shipped, or one of those that are made when they are needed."""
    if name == NAMES[0]:
        return read_table(DATA / f"{name}.csv", list(COLUMNS))
    return independent_run(NAMES.index(name), COLUMNS)


def excursion(values: np.ndarray) -> float:
    """The mean distance from end to end."""
    return float(values[find_peaks(values)[0]].mean() - values[find_peaks(-values)[0]].mean())


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


def test_the_motion_is_of_the_size_of_table_6_2() -> None:
    """Its "mean total displacement" can only be from end to end, as docs/physics.md explains."""
    train = shipped("swing-train")[:, 3:] * STORY["mm_per_unit"]
    found = [excursion(column) for column in train.T]
    assert found == pytest.approx([8.9, 330, 26.8], rel=0.15)
    # With a mean distance from rest, the mass would have to move farther than the length of its
    # arm.
    assert math.pi / 2 * 330 > 480 > excursion(train[:, 1])


def test_the_command(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tactus.physics.swing_data", str(tmp_path)]
    result = subprocess.run(
        [*command, "--angles", "20", "--seed", "9"], cwd=ROOT, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"swing-train.csv", "swing.toml"}
    result = subprocess.run([*command, "--angles", "80"], cwd=ROOT, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (2, "error: angle: got 80, expected -60 to 60\n")


def test_raw_signals_are_the_10_to_60_mv_of_section_6_4_2() -> None:
    """Both ends, and the gains of 10 and 80, follow from one sensitivity, which we chose."""
    recording = record(ANGLES[0], 1, 0.0)
    raw = 1e3 * np.ptp(recording.sensors, axis=0) / [10, 80, 10]
    assert raw[[0, 2]] == pytest.approx(60, rel=0.08)
    assert raw[1] == pytest.approx(10, rel=0.08)


def test_targets_are_coded_as_section_6_4_4_has_it() -> None:
    targets = shipped("swing-train")[:, 3:]
    assert np.abs(targets).max(axis=0) == pytest.approx(BOUND, abs=1e-4)
    assert targets.mean(axis=0) == pytest.approx(0, abs=1e-4)
    for name in NAMES[1:]:
        # The seed decides how large a wobble is, independently of the training run.
        assert np.abs(shipped(name)[:, 4:]).max() < BOUND
        assert np.abs(shipped(name)[:, 3]).max() < BOUND / LEAST_WOBBLE


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


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Swing(arm=1e-4), "arm: got 0.0001, expected 0.001 to 100"),
        (lambda: Swing(feet=1.44), "feet: got 1.44, expected 0.00072 to 1.43928"),
        (lambda: swing_motion(FREE, 4, 1), "start: got 4, expected -3.14159 to 3.14159"),
        (lambda: swing_motion(FREE, 1, 0), "seconds: got 0, expected 0.01 to 50000"),
        (lambda: swing_motion(FREE, 1, 1, method="Euler"), "method: got 'Euler', expected one of"),
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
