"""Tests make sensors, which finds the best places of gauges on a beam."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError
from tactus.physics.bound import MEAN_PER_DEVIATION
from tactus.physics.gauge_places import Placing
from tactus.physics.gauge_rig import FOLDER, GaugeRig, load_rig
from tactus.physics.strain_sensor import StrainSensor
from tactus.report import gauges

TEXT = (FOLDER / "digit.toml").read_text()


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


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[beam]", "[bean]", "section 'bean' is not known, .*did you mean 'beam'"),
        ("count = 3", "counts = 3", "gauges: key 'counts' is not known, .*did you mean 'count'"),
        ("count = 3\n", "", "gauges.count: missing, expected a whole number, 1 to 32"),
        ("count = 3", "count = 3.5", "gauges.count: got 3.5, expected a whole number, 1 to 32"),
        ("count = 3", "count = 0", "gauges.count: got 0, expected a whole number"),
        ("count = 3", "count = 30", r"gauges.to_mm: got 215.0, expected room for 30 gauges 8 mm"),
        ("length_mm = 228.6", "length_mm = nan", r"beam.length_mm: got nan, expected a number"),
        ("length_mm = 228.6", "length_mm = 150", r"loads.position_mm: got \[101.6, 215.9\]"),
        ("thickness_mm = 0.4", 'thickness_mm = "0.4"', "beam.thickness_mm: got '0.4', expected"),
        ("noise_v = 0.002\nnoise_strain = 2e-7", "noise_v = 0\nnoise_strain = 0", "noise_v: got 0"),
        ("compare_mm = [0.5", "compare_mm = [-5", "compare_mm: got .*places on the beam, 0 to 228"),
        ("load_g = [6.0, 23.0]", "load_g = [23.0, 6.0]", "load_g: got .*the least and the largest"),
        ("load_g = [6.0, 23.0]", "load_g = [0, 23.0]", "expected loads and widths above 0"),
        ("width_mm = [12.7, ", "width_mm = [-12.7, ", "expected loads and widths above 0"),
        ("width_mm = [12.7, 25.4, 38.1, 50.8]", "width_mm = []", "width_mm: got .*list of numbers"),
        ('"triangle"]', '"cone"]', "shapes: got 'cone', expected one of rectangle, triangle"),
        ('"width"]', '"depth"]', "outputs: got 'depth', expected one of load, position, width"),
        (", width = 50.8", "", "errors.length_mm.width: missing, expected what 100 % of width is"),
        ("position = 127.0", "position = 0", "errors.length_mm: got .*position = , width = "),
        ('"mean"', '"median"', "errors.objective: got 'median', expected mean or worst"),
        ("[load_cell]", "load_cell = 3\n[load_cells]", "section 'load_cells'|load_cell"),
        ("[loads]", "[loads", "not TOML"),
    ],
)
def test_a_fault_names_file_key_got_and_expected(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    assert old in TEXT
    path = tmp_path / "faulty.toml"
    path.write_text(TEXT.replace(old, new, 1))
    with pytest.raises(InputError, match=f"^{re.escape(str(path))}: .*{message}"):
        load_rig(str(path))


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
