"""Each study begins as its result says, and what it needs and is not there is named."""

import hashlib
import itertools
import re
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pages
import pytest
from conftest import tiered

from golden.input_error import InputError, MissingFileError
from golden.layers import input_integral
from golden.numbers.fixed import Fix
from studies.__main__ import FOLDER, differences, finished, measured, names, recorded, same
from studies.beans import study as beans
from studies.drift import study as drift
from studies.gripper import study as gripper
from studies.stability import conditioned, networks, physics, study
from studies.stability.case import Row
from studies.stability.digits import deflection
from studies.stability.reference_swing import reference_swing
from tactus.physics.plate import Plate
from tactus.physics.swing import Swing, swing_motion
from tactus.recalibration import fit
from tactus.report.measure.table import Cell, Table
from tactus.scene import load_scene
from tactus.train import descents
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

# Studies whose first row takes long, or needs what a computer without a network does not have; and
# one that is measured whole below.
NOT_BEGUN = {"judge", "peers", "stability"}
# These train or learn before their first row.
LONG = {"halved_search", "learned_functions", "on_line_learning"}
# Studies that bring data of others.
BRING = {
    "beans": beans.DATA,
    "drift": drift.DATA,
    "gripper": gripper.TEST,
    "halved_search": gripper.DATA,
}
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
    assert load_scene(str(path)).twin().core.interval == 1579


def test_adder_graphs_in_a_row_give_what_an_engine_gives(tmp_path: Path) -> None:
    networks = [random_mlp((inputs, 3, 1), 0.5, inputs) for inputs in (2, 3)]
    path = write_scene(tmp_path, "row", "exact", networks, "cascade", "precise", design="engine")
    scene = load_scene(str(path))
    codes = scene.vectors().codes
    row, engine = gripper.in_a_row(scene, codes), scene.twin().core.process(codes)
    assert np.abs(row - engine).max() < 20 < np.ptp(engine, axis=0).min()


# A smaller error only consists of last bits.
UNSEEN = 1e-9


@pytest.fixture(scope="module")
def found() -> Table:
    return table_of(list(study.rows()))


def table_of(rows: list[dict[str, Cell]]) -> Table:
    return Table("stability", list(rows[0]), [list(row.values()) for row in rows], "")


@pytest.mark.all_only
def test_every_case_holds(found: Table) -> None:
    assert [row for row in found.rows if row[-1] != "yes"] == []
    assert all(value <= bound for *_, value, bound, _ in found.rows)


@pytest.mark.all_only
def test_the_result_is_what_is_measured(found: Table) -> None:
    """Last bits and errors of integrators depend on machines."""
    shown = recorded("stability").rows
    again = "make study NAME=stability RECORD=1, then docs/stability.md"
    assert [row[:4] for row in shown] == [row[:4] for row in found.rows], f"run: {again}"
    for before, now in zip(shown, found.rows, strict=True):
        assert before[5] == pytest.approx(now[5], rel=pages.ROUNDING), f"{now}; run: {again}"
        pair = [float(row[4]) for row in (before, now)]
        assert max(pair) < UNSEEN or min(pair) >= (1 - pages.SEARCHED) * max(pair), (
            f"{now}; run: {again}"
        )


@pytest.mark.parametrize("value", [2.0, float("nan"), float("inf")])
def test_a_case_that_breaks_its_bound_says_no(monkeypatch, value: float) -> None:
    rows = [Row("x", "a", "b", "y", value, 1.0), Row("x", "c", "b", "y", 1, 1)]
    monkeypatch.setattr(study, "CASES", (lambda: iter(rows),))
    made = table_of(list(study.rows()))
    assert [row[-1] for row in made.rows] == ["no", "yes"]
    assert made.rows[0][4] == (value if value == 2 else None)


def broken(cases) -> set[tuple[str, str]]:
    """The models and figures of cases that do not hold."""
    return {(row.model, row.figure) for row in cases() if not row.holds}


def test_a_hidden_sum_that_wraps_says_no(monkeypatch) -> None:
    """Adders of the thesis would wrap without normalisation."""
    right = input_integral.requantise

    def wrapping(codes, shift, target: Fix, rounding, overflow):
        return right(codes, shift, target, rounding, input_integral.Overflow.WRAP)

    monkeypatch.setattr(input_integral, "requantise", wrapping)
    found = broken(networks.rails)
    assert ("digit-hybrid", "codes off") in found
    assert ("digit-hybrid", "error in 2^-13") in found
    assert ("hybrid", "codes off") in broken(networks.huge_weights)


@pytest.mark.parametrize("fault", ["stands still", "looser tolerance"])
def test_a_stiff_swing_that_is_solved_wrongly_says_no(monkeypatch, fault: str) -> None:
    right = physics.swing_motion

    def wrong(swing, start: float, *rest, **options):
        if fault == "looser tolerance":
            return right(swing, start, *rest, **options, tolerance=1e-4)
        motion = right(swing, start, *rest, **options)
        still = np.full_like(motion.angle, start)
        return replace(motion, angle=still, speed=np.zeros_like(still))

    monkeypatch.setattr(physics, "swing_motion", wrong)
    stiff = list(itertools.islice(physics.swings(), 9))
    assert [(row.case[:6], row.holds) for row in stiff if "error" in row.figure] == [
        ("damped", False)
    ] * 6
    if fault == "stands still":
        assert not any(row.holds for row in stiff)


def _normal_equations(aim, start, steps):
    slopes, errors = aim.jacobian(start), aim.residuals(start)
    return np.linalg.lstsq(slopes.T @ slopes, -slopes.T @ errors, rcond=1e-15)[0]


def _root_of_product(slopes):
    values, vectors = np.linalg.eigh(np.linalg.inv(slopes.T @ slopes))
    return vectors * np.sqrt(np.abs(values))


@pytest.mark.parametrize(
    ("module", "name", "fault", "cases", "model"),
    [
        (descents, "levenberg_marquardt", _normal_equations, "networks", "Levenberg-Marquardt"),
        (fit, "root_of_inverse", _root_of_product, "recalibration", "recalibration"),
    ],
)
def test_a_formula_that_loses_digits_says_no(
    monkeypatch, module, name: str, fault, cases: str, model: str
) -> None:
    monkeypatch.setattr(module, name, fault)
    assert model in {model for model, _ in broken(getattr(conditioned, cases))}


@pytest.mark.parametrize("rate", [0.1, 1e2, 1e6])
def test_the_judge_of_swings_agrees_with_a_third_family(rate: float) -> None:
    """Radau IIA at its least tolerance, where the judge does not know how well it does itself."""
    swing = Swing(damping=rate * Swing().arm)
    times = np.arange(200) / 100
    angle, speed, unsure = reference_swing(swing, 0.5, times)
    found = swing_motion(swing, 0.5, 2, 100, method="Radau", tolerance=1e-13)
    assert unsure < 1e-10
    assert np.abs(found.angle - angle).max() < 1e-13
    assert np.abs(found.speed - speed).max() < 1e-11


def test_the_deflection_in_more_digits_is_the_series_where_that_converges() -> None:
    """Far from the load the terms vanish; near the corner all four edges count."""
    for clamped in (True, False):
        sheet = replace(Plate(), clamped=clamped)
        point, load = (0.1, 0.05), (0.3, 0.4)
        exact = float(deflection(sheet, point, load))
        assert sheet.influence([point], [load])[0, 0] == pytest.approx(exact, rel=1e-11)
