"""Tests make sensors, which finds the best places of gauges on a beam."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError, MissingFileError
from tactus.physics.bound import MEAN_PER_DEVIATION
from tactus.physics.gauge_places import Placing
from tactus.physics.gauge_rig import FOLDER, GaugeRig, load_rig
from tactus.physics.strain_sensor import StrainSensor
from tactus.report import gauges
from tactus.report.draw.gauges import along

TEXT = (FOLDER / "digit.toml").read_text()


@pytest.fixture(scope="module")
def rig() -> GaugeRig:
    return load_rig("digit")


def test_the_shipped_rig_has_the_fitted_sensors(rig: GaugeRig) -> None:
    """Every placement lies on the beam, and the largest moment fills the range."""
    loads = rig.placements
    assert (loads.position + loads.half_width).max() <= rig.beam.length - 0.00635 + 1e-12
    assert len(np.unique(loads.position)) > 20
    assert rig.known == (False, False, False)
    assert [1e3 * place for place in rig.compare] == pytest.approx([0.5, 86.9, 149.9])


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


def test_a_width_that_no_gauge_feels_is_a_guess(rig: GaugeRig) -> None:
    errors = Placing(rig).errors([0.0, 0.03, 0.06])
    guess = 100 * MEAN_PER_DEVIATION * (50.8 - 12.7) / math.sqrt(12) / 50.8
    assert errors[:, 2] == pytest.approx(guess)
    assert errors[:, :2].max() < 5


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


def test_more_gauges_never_tell_less_and_the_best_is_no_worse_than_what_is_compared(
    rig: GaugeRig,
) -> None:
    placing = Placing(rig)
    scores = [float(placing.score(placing.errors(rig.compare)))]
    for count in (3, 4):
        places = Placing(replace(rig, count=count)).best()
        assert places == Placing(replace(rig, count=count)).best()
        assert np.diff(places).min() >= rig.apart - 1e-9
        assert rig.span[0] <= places[0]
        assert places[-1] <= rig.span[1]
        scores.append(float(placing.score(placing.errors(places))))
    assert scores == sorted(scores, reverse=True)
    assert scores[0] > scores[2]


def test_an_output_of_one_value_is_known(tmp_path: Path) -> None:
    path = tmp_path / "narrow.toml"
    text = TEXT.replace("width_mm = [12.7, 25.4, 38.1, 50.8]", "width_mm = [12.7]")
    path.write_text(text.replace('"position", "width"]', '"position"]'))
    narrow = load_rig(str(path))
    assert narrow.known == (False, False, True)
    errors = Placing(narrow).errors(narrow.compare)
    assert (errors[:, 2] == 0).all()
    wide = Placing(load_rig("digit")).errors(narrow.compare)
    assert errors[:, 1].max() < wide[:, 1].max()


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


def test_an_unknown_rig_is_told() -> None:
    with pytest.raises(MissingFileError, match=r"RIG=digits: no such rig, .*did you mean 'digit'"):
        load_rig("digits")
    with pytest.raises(MissingFileError, match=r"gone\.toml: no such file"):
        load_rig("gone.toml")


def test_no_room_is_told(rig: GaugeRig) -> None:
    crowded = replace(rig, count=3, span=(0.1, 0.12), apart=0.0099, compare=())
    assert len(Placing(crowded).best()) == 3
    near = replace(crowded, span=(0.1, 0.15), compare=(0.11, 0.112, 0.114))
    assert np.diff(Placing(near).best()).min() > 0.0098
    with pytest.raises(InputError, match=r"gauges.apart_mm: got 15, expected room for 3 gauges"):
        Placing(replace(crowded, apart=0.015)).best()


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


def test_the_picture_is_of_the_errors(rig: GaugeRig) -> None:
    placing = Placing(rig)
    shown = along(placing, rig.compare)
    errors = placing.errors(rig.compare)
    for c, name in enumerate(rig.outputs):
        place, value = shown[name][5]
        here = np.isclose(1e3 * rig.placements.position, place)
        assert value == pytest.approx(errors[here, c].mean())
        assert 1e3 * rig.placements.position.min() <= place <= 215.9
