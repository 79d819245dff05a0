"""Each study begins as its result says, and what it needs and is not there is named."""

import hashlib
import re
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from conftest import tiered

from golden.input_error import InputError, MissingFileError
from studies.__main__ import FOLDER, differences, finished, measured, names, recorded, same
from studies.beans import study as beans
from studies.drift import study as drift
from studies.gripper import study as gripper
from tactus.report.measure.table import Table
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

# Studies whose first row takes long, or needs what a computer without a network does not have; and
# one that test_stability.py measures whole.
NOT_BEGUN = {"peers", "stability"}
# These train or learn before their first row.
LONG = {"learned_functions", "on_line_learning"}
# Studies that bring data of others.
BRING = {"beans": beans.DATA, "drift": drift.DATA, "gripper": gripper.TEST}
# Of floating point on another processor.
ROUNDING = 0.1


@pytest.mark.parametrize("name", tiered(sorted({*names()} - NOT_BEGUN - LONG), sorted(LONG)))
def test_a_study_begins_as_its_result(name: str) -> None:
    if name in BRING and not BRING[name].is_file():
        pytest.skip(f"make study NAME={name} brings its data")
    table = recorded(name)
    (first,) = islice(measured(name), 1)
    assert list(first) == list(table.columns)
    for cell, expected in zip(first.values(), table.rows[0], strict=True):
        assert same(cell, expected, ROUNDING), (cell, expected)


@pytest.mark.parametrize("name", finished())
def test_a_page_of_a_study_fits_two_screens(name: str) -> None:
    assert recorded(name).rows
    text = (FOLDER / name / "README.md").read_text(encoding="utf-8")
    again = "make study NAME=" in text
    assert again == (name in names())
    assert again or re.search(r"program\s+of\s+revision [0-9a-f]{12}", text)
    assert len(text.splitlines()) <= 100
    for word in ("Question", "Method", "Result", "What follows"):
        assert f"**{word}.**" in text or f"## {word}" in text


def test_what_differs_is_told() -> None:
    one = Table("some", ["a", "b"], [["x", 1.0], ["y", None]], "")
    assert list(differences(one, one)) == []
    other = Table("some", ["a", "b"], [["x", 1.1], ["y", None]], "")
    assert list(differences(one, other)) == ["row 1: b: recorded 1.0, measured 1.1"]
    assert len(list(differences(one, Table("some", ["a", "b"], [["x", 1.0]], "")))) == 2


def test_a_scene_without_its_data_says_where_they_are(tmp_path: Path) -> None:
    path = tmp_path / "beans-tables.toml"
    path.write_bytes(beans.SCENE.read_bytes())
    with pytest.raises(MissingFileError, match=r"beans\.csv: no such file; make study .* 382e279c"):
        load_scene(str(path))


def test_other_data_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beans, "DATA", tmp_path / "beans.csv")
    (tmp_path / "other.csv").write_text("Class\nSEKER\n")
    with pytest.raises(InputError, match=r"got sha256 .*, expected 26266219"):
        beans.bring((tmp_path / "other.csv").as_uri())
    assert not beans.DATA.exists()


def test_halves_of_a_recording_are_joined_and_other_halves_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    halves = {"pose.csv": b"1,2\n3,4\n", "force.csv": b"5\n6"}
    for name, data in halves.items():
        (tmp_path / name).write_bytes(data)
    digests = {name: hashlib.sha256(data).hexdigest() for name, data in halves.items()}
    path = tmp_path / "joined.csv"
    monkeypatch.setattr(gripper, "FOLDER", tmp_path)
    monkeypatch.setattr(gripper, "ADDRESS", f"{tmp_path.as_uri()}/")
    monkeypatch.setattr(gripper, "COLUMNS", ["a", "b", "c"])
    monkeypatch.setattr(gripper, "PARTS", {path: digests})
    gripper.bring()
    assert path.read_text() == "a,b,c\n1,2,5\n3,4,6\n"
    path.unlink()
    (tmp_path / "force.csv").write_bytes(b"5\n7")
    with pytest.raises(InputError, match=r"force\.csv: got sha256 .*, expected"):
        gripper.bring()
    assert not path.exists()


def test_a_nose_smells_the_relative_change_of_each_sensor() -> None:
    row = ",1000,10,0,0,0,0,0,0" * 15 + ",1000,1,0,0,0,0,0,0 \n"
    found = drift.converted(f"Acetone,10.0{row}Ethanol,10.0{row}")
    assert found == "0.2000," * 15 + "-0.8000,-1.0000\n"


def test_a_gripper_has_the_networks_that_it_brings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gripper, "FOLDER", tmp_path)
    monkeypatch.setattr(gripper, "PARTS", {})
    gripper.bring()
    rows = [f"{','.join('0' * 21)}\n"] * 9
    (tmp_path / "gripper.csv").write_text("".join([",".join(gripper.COLUMNS) + "\n", *rows]))
    path = tmp_path / "gripper.toml"
    path.write_bytes(gripper.SCENE.read_bytes())
    assert load_scene(str(path)).twin().core.interval == 1601


def test_adder_graphs_in_a_row_give_what_an_engine_gives(tmp_path: Path) -> None:
    networks = [random_mlp((inputs, 3, 1), 0.5, inputs) for inputs in (2, 3)]
    path = write_scene(tmp_path, "row", "exact", networks, "cascade", "precise", design="engine")
    scene = load_scene(str(path))
    codes = scene.vectors().codes
    row, engine = gripper.in_a_row(scene, codes), scene.twin().core.process(codes)
    assert np.abs(row - engine).max() < 20 < np.ptp(engine, axis=0).min()
