"""Each study begins as its result says, and what it needs and is not there is named."""

import re
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError, MissingFileError
from golden.layers.input_integral import InputIntegral
from golden.numbers.fixed import Codes, Overflow, Rounding, requantise
from studies.__main__ import FOLDER, differences, measured, names, recorded, same
from studies.beans import study as beans
from studies.gripper import study as gripper
from studies.physics.plate import Plate
from studies.stability import networks, study
from studies.stability.case import Row
from studies.stability.digits import deflection
from tactus.report.measure.table import Table
from tactus.scene import load_scene

# Studies that bring data of others. The rest runs for hours, except for one that is measured whole
# below.
BRING = {"beans": beans.DATA, "gripper": gripper.TEST}
# Of floating point on another processor.
ROUNDING = 0.1
PAGES = FOLDER.parent / "docs" / "studies"


@pytest.mark.parametrize("name", BRING)
def test_a_study_begins_as_its_result(name: str) -> None:
    if not BRING[name].is_file():
        pytest.skip(f"make study NAME={name} brings its data")
    table = recorded(name)
    (first,) = islice(measured(name), 1)
    assert list(first) == list(table.columns)
    for cell, expected in zip(first.values(), table.rows[0], strict=True):
        assert same(cell, expected, ROUNDING), (cell, expected)


@pytest.mark.parametrize("name", names())
def test_a_page_of_a_study_fits_two_screens(name: str) -> None:
    assert recorded(name).rows
    text = (FOLDER / name / "README.md").read_text(encoding="utf-8")
    assert f"make study NAME={name}" in text
    assert len(text.splitlines()) <= 100
    for word in ("Question", "Method", "Result", "What follows"):
        assert f"**{word}.**" in text or f"## {word}" in text


@pytest.mark.parametrize("page", sorted(PAGES.glob("*.md")), ids=lambda page: page.name)
def test_a_study_that_is_not_measured_again_names_the_revision_that_did(page: Path) -> None:
    assert re.search(r"revision\s+[0-9a-f]{12}", page.read_text(encoding="utf-8"))


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


@pytest.mark.all_only
def test_every_stiff_case_holds_and_is_recorded() -> None:
    found, shown = ([list(row.values()) for row in study.rows()], recorded("stability").rows)
    assert [row for row in found if row[-1] != "yes"] == []
    again = "run: make study NAME=stability RECORD=1, then docs/stability.md"
    assert [row[:4] for row in shown] == [row[:4] for row in found], again


@pytest.mark.parametrize("value", [2.0, float("nan"), float("inf")])
def test_a_case_that_breaks_its_bound_says_no(monkeypatch, value: float) -> None:
    rows = [Row("x", "a", "b", "y", value, 1.0), Row("x", "c", "b", "y", 1, 1)]
    monkeypatch.setattr(study, "CASES", (lambda: iter(rows),))
    first, second = (list(row.values()) for row in study.rows())
    assert [first[-1], second[-1]] == ["no", "yes"]
    assert first[4] == (value if value == 2 else None)


def test_a_hidden_sum_that_wraps_says_no(monkeypatch) -> None:
    """Adders of the thesis would wrap without normalisation."""

    def wrapping(block: InputIntegral, frames: Codes) -> Codes:
        sums = block.exact(frames) * np.array(block.row_factors)
        return requantise(sums, block.out_shift, block.out_fmt, Rounding.ROUND, Overflow.WRAP)

    monkeypatch.setattr(InputIntegral, "process", wrapping)
    found = {(row.model, row.figure) for row in networks.rails() if not row.holds}
    assert {("digit-hybrid", "codes off"), ("digit-hybrid", "error in 2^-13")} <= found


def test_the_deflection_in_more_digits_is_the_series_where_that_converges() -> None:
    """Far from the load the terms vanish; near the corner all four edges count."""
    for clamped in (True, False):
        sheet = replace(Plate(), clamped=clamped)
        point, load = (0.1, 0.05), (0.3, 0.4)
        exact = float(deflection(sheet, point, load))
        assert sheet.influence([point], [load])[0, 0] == pytest.approx(exact, rel=1e-11)
