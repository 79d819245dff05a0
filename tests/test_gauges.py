"""Tests make sensors, which finds the best places of gauges on a beam."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tactus.physics.bound import MEAN_PER_DEVIATION
from tactus.physics.gauge_places import Placing
from tactus.physics.gauge_rig import GaugeRig, load_rig
from tactus.physics.strain_sensor import StrainSensor
from tactus.report import gauges


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


def test_the_command_prints_and_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["make sensors", "digit", "--build", str(tmp_path)])
    gauges.main()
    printed = capsys.readouterr().out
    picture = (tmp_path / "sensors" / "digit" / "sensors.svg").read_text()
    for label in ("compared", "best found"):
        assert f">{label}</text>" in picture
        assert len(re.findall(rf"^{label} ", printed, re.M)) == 3
    rows = (tmp_path / "sensors" / "digit" / "sensors.csv").read_text().splitlines()
    assert len(rows) == 1 + 6
