"""Tests the physics: beam, gauges and their places, swing and plate, and what is recorded."""

import hashlib
import itertools
import math
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refused import call
from scipy.integrate import quad

from studies.physics.plate import Plate
from studies.physics.swing import Swing, bearing_forces, foot_forces, swing_motion
from studies.physics.swing_data import ANGLES, independent_run, write_recordings
from studies.physics.swing_data import COLUMNS as RUN
from tactus.core.table import read_table
from tactus.physics.beam import GRAVITY, arm_slopes, mean_arm, strain
from tactus.physics.gauges import MEAN_PER_DEVIATION, GaugeRig, load_rig


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
    found = rig.errors(places)
    for n in range(0, len(found), 37):
        rows, noise = [], []
        for place in places:
            strains, slopes = strain(rig.beam, place, rig.placements)
            gain = rig.full_scale / np.abs(strains).max()
            rows.append(gain * slopes[n])
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
    pairs = [
        (few.score(few.errors_of(few._all[list(pair)].sum(axis=0))), pair)
        for pair in itertools.combinations(range(0, len(few.places), 2), 2)
        if few.places[pair[1]] - few.places[pair[0]] >= few.apart
    ]
    assert few.score(few.errors(few.best())) <= min(score for score, _ in pairs)


def test_the_command_prints_and_writes(tmp_path: Path, capsys) -> None:
    call("sensors", "digit", "--build", tmp_path)
    printed = capsys.readouterr().out
    picture = (tmp_path / "sensors" / "digit" / "sensors.svg").read_text()
    for label in ("compared", "best found"):
        assert f">{label}</text>" in picture
        assert len(re.findall(rf"^{label} ", printed, re.M)) == 3
    rows = (tmp_path / "sensors" / "digit" / "sensors.csv").read_text().splitlines()
    assert len(rows) == 1 + 6


FREE = Swing(damping=0)


def test_the_rig_is_that_of_section_6_2_2() -> None:
    assert FREE.natural_frequency / (2 * math.pi) == pytest.approx(0.7, rel=0.03)
    assert math.degrees(2 * FREE.half_angle) == pytest.approx(49.25, abs=0.005)


def test_bearing_forces_are_what_accelerates_the_mass() -> None:
    """Newton's law is tested for the centre of mass, whose path is differentiated twice."""
    swing = FREE
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


def test_shipped_recordings_are_those_of_their_provenance_and_can_be_made_again(
    tmp_path: Path,
) -> None:
    data = (DATA / f"{NAMES[0]}.csv").read_bytes()
    assert hashlib.sha256(data).hexdigest() == STORY[NAMES[0]]["sha256"]
    paths = write_recordings(tmp_path)
    assert [path.name for path in paths] == [*(f"{name}.csv" for name in NAMES), "swing.toml"]
    # One run is shipped, and the others are made when they are needed.
    runs = [read_table(DATA / paths[0].name, RUN), *(independent_run(n, RUN) for n in range(1, 5))]
    for path, run in zip(paths[:-1], runs, strict=True):
        assert run.shape == (STORY[path.stem]["rows"], 6) == (5000, 6)
        assert STORY[path.stem]["clipped"] == 0
        # Other versions of numpy and SciPy may round the last digit differently.
        assert np.abs(read_table(path, RUN) - run).max() <= 1.3e-4
    again = tomllib.loads(paths[-1].read_text(encoding="utf-8"))
    assert again["offset_mm"] == pytest.approx(STORY["offset_mm"])
    assert again["mm_per_unit"] == pytest.approx(STORY["mm_per_unit"])
    assert [STORY[name]["angle_degrees"] for name in NAMES] == list(ANGLES)
    assert [STORY[name]["seed"] for name in NAMES] == [1, 2, 3, 4, 5]


# w D / (P a^2) in the middle, with the load there, for b / a.
TIMOSHENKO = {1.1: 0.01265, 1.2: 0.01353, 1.4: 0.01484, 1.6: 0.0157, 1.8: 0.0162}
TIMOSHENKO |= {2.0: 0.01651, 3.0: 0.0169}


@pytest.mark.parametrize(("ratio", "alpha"), TIMOSHENKO.items())
def test_supported_plates_of_timoshenko_table_23(ratio: float, alpha: float) -> None:
    """They agree as well as the few terms allow, which were computed by hand."""
    plate = Plate(1.0, ratio, clamped=False)
    middle = np.array([[0.5 * plate.length, 0.5 * plate.width]])
    found = plate.influence(middle, middle, 5000)[0, 0] * plate.stiffness
    assert found == pytest.approx(alpha, rel=2.5e-3)
