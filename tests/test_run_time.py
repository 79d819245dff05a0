"""Tests docs/error-against-run-time.md: its records are current, and each default is the best."""

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from pages import ROUNDING, SEARCHED

from golden.activation.pade import RHO
from golden.numbers.precision import EXACT
from tactus.errors.scene_errors import scene_errors
from tactus.physics.plate import TERMS
from tactus.physics.swing import LIGHT, METHODS, STRONG, STRONG_DAMPING
from tactus.report.draw.findings import number, rows_of
from tactus.report.draw.run_time import SETTLING, network_rows, rounded
from tactus.report.measure import table_records
from tactus.report.measure.costs import with_activation_cells, with_network_cells
from tactus.report.measure.simulators import SCENE
from tactus.report.measure.table import Cell, Table
from tactus.report.page import run_time
from tactus.scene import load_scene
from tactus.scene.schema import TRAINING

SVG = "{http://www.w3.org/2000/svg}"
# These records are measured again in every run, and end alike on every machine.
COMPARED = ("series", "plate", "swing", "swing_damping", "iterations")
# Smaller errors of integration differ by a factor of 2.2 between processors, larger ones by 2 %.
FINE = 1e-9


@pytest.fixture(scope="module")
def tables() -> run_time.Tables:
    """The recorded tables."""
    return {name: table_records.read(name) for name in table_records.FOR_PAGES}


@pytest.fixture(scope="module")
def measured(measured_tables: dict[str, Table]) -> dict[str, Table]:
    """The tables that are measured in every run."""
    return measured_tables


def agrees(heading: str, old: Cell, new: Cell) -> bool:
    if not isinstance(old, int | float) or not isinstance(new, int | float):
        return old == new
    if heading == "error rad" and old < FINE:
        return old < 3 * new < 9 * old
    bound = SEARCHED if heading in ("error rad", "evaluations") else ROUNDING
    return abs(old - new) <= bound * abs(old) + 1e-14


@pytest.mark.parametrize("name", COMPARED)
def test_what_is_recorded_is_what_is_measured(
    tables: run_time.Tables, measured: dict[str, Table], name: str
) -> None:
    old, new = tables[name].without_times(), measured[name].without_times()
    assert (old.columns, len(old.rows), old.note) == (list(new.columns), len(new.rows), new.note)
    for before, now in zip(old.rows, new.rows, strict=True):
        for heading, cell, other in zip(old.columns, before, now, strict=True):
            assert agrees(heading, cell, other), (
                f"{before}: run: make figures TABLE={name} RECORD=1"
            )


def test_a_record_of_other_figures_is_found_out() -> None:
    assert not agrees("error", 1.519e-6, 1.520e-6)
    assert not agrees("evaluations", 1040, 1100)
    assert not agrees("error rad", 2e-10, 1e-9)
    assert not agrees("error rad", None, 1e-9)
    assert agrees("error rad", 2e-10, 3e-10)
    assert not agrees("method", "RK23", "RK45")


def test_the_recorded_descents_begin_where_todays_do(
    tables: run_time.Tables, measured: dict[str, Table]
) -> None:
    """The page shows where they end as a range, because a last bit changes that."""

    def starts(table: Table) -> list[tuple]:
        rows = rows_of(table, evaluations=1)
        return [tuple(row[name] for name in ("method", "output", "restart")) for row in rows]

    old, new = tables["training"], measured["training"]
    assert (list(old.columns), old.note) == (list(new.columns), new.note)
    assert starts(old) == starts(new)
    for before, now in zip(rows_of(old, evaluations=1), rows_of(new, evaluations=1), strict=True):
        for heading in ("validation %", "test %"):
            assert number(before, heading) == pytest.approx(number(now, heading), rel=ROUNDING)


def test_every_simulator_played_the_frames_of_the_default_scene(tables: run_time.Tables) -> None:
    scene, rows = load_scene(SCENE), rows_of(tables["simulators"])
    frames = len(scene.vectors().codes)
    worst = {k: max(e.mean for e in found) for k, found in scene_errors(scene).items()}
    for row in rows:
        kind = "float" if str(row["simulator"]).startswith("float") else "bit-true"
        error = number(row, "mean error %, worst output")
        assert error == pytest.approx(worst[kind], rel=ROUNDING)
        assert row["frames"] == frames or "repeated" in str(row["simulator"])
    compared = [number(row, "values compared, all equal") for row in rows[3:]]
    assert min(compared) >= frames * len(scene.outputs)
    for start in run_time.SHOWS:
        assert any(str(row["simulator"]).startswith(start) for row in rows), start


def test_every_time_is_of_one_machine() -> None:
    assert table_records.machine() in run_time.PAGE.read_text(encoding="utf-8")


def test_the_pages_show_every_picture_and_nothing_else_lies_there() -> None:
    text = "".join(page.read_text("utf-8") for page in (run_time.PAGE, run_time.TABLES))
    shown = re.findall(rf"!\[[^\]]+\]\({run_time.NAME}/(\w+)\.svg\)", text)
    assert sorted(shown) == sorted(run_time.DRAWN)
    assert sorted(path.name for path in run_time.FOLDER.iterdir()) == sorted(
        f"{name}.svg" for name in run_time.DRAWN
    )


@pytest.mark.parametrize("name", run_time.DRAWN)
def test_a_picture_is_accessible_and_has_units_on_its_axes(name: str) -> None:
    text = Path(run_time.FOLDER / f"{name}.svg").read_text(encoding="utf-8")
    root = ElementTree.fromstring(text)
    assert root.get("role") == "img"
    assert root[0].tag == f"{SVG}title"
    assert (root[0].text or "").strip()
    ids = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(ids) == len(set(ids))
    words = " ".join("".join(element.itertext()) for element in root.iter(f"{SVG}text"))
    of = "clocks|LUTs|µs|ms|, s|iterations|terms|natural frequencies|frames a second"
    assert re.search(of, words)


def test_the_default_network_errs_least_and_is_the_smallest(measured: dict[str, Table]) -> None:
    rows = network_rows(with_network_cells(measured["clocks"]))
    rows = [row for row in rows if row["outputs"] == 4]
    (default,) = (row for row in rows if row["scene"] == SCENE)
    assert number(default, "largest %") <= min(number(row, "largest %") for row in rows) + 1e-9
    # One lane takes fewer LUTs, for one block RAM more. An engine of learned functions takes fewer
    # too, and errs more.
    (learned,) = (row for row in rows if row["scene"] == "digit-sums")
    smaller = [row for row in rows if number(row, "LUT") < number(default, "LUT")]
    assert sorted(map(str, (row["scene"] for row in smaller))) == ["digit-lanes1", "digit-sums"]
    assert number(learned, "largest %") > number(default, "largest %")
    (folded,) = (row for row in rows if row["scene"] == run_time.FOLDED)
    assert number(folded, "clocks a frame") < number(default, "clocks a frame")


def test_the_default_activation_errs_least_of_those_with_a_multiplier(
    measured: dict[str, Table],
) -> None:
    table = with_activation_cells(measured["activations"])
    rows = [row for row in rows_of(table) if row["multiplier"]]
    best = min(rows, key=lambda row: number(row, "largest units"))
    assert best["scheme"] == EXACT.activation


def test_the_default_rho_settles_first(tables: run_time.Tables) -> None:
    settled = run_time.settled_after(tables)
    assert set(settled) < set(SETTLING)
    assert min(settled, key=lambda rho: (settled[rho], rho)) == RHO


def test_the_default_optimiser_is_ahead_after_a_second(tables: run_time.Tables) -> None:
    default = str(TRAINING.keys["optimiser"].default)
    for seconds in (run_time.LATE, float("inf")):
        best = {m: run_time.best_error(tables, m, seconds) for m in ("levenberg-marquardt", "scg")}
        assert min(best, key=lambda method: best[method]) == default


def test_the_default_integrators_take_the_least_recorded_time(tables: run_time.Tables) -> None:
    for case in ("plain", "179.9 degrees"):
        assert run_time.quickest(tables, case)[0] == LIGHT
    assert run_time.quickest(tables, "strongly damped")[0] == STRONG
    assert {LIGHT, STRONG} < set(METHODS)
    for row in rows_of(tables["swing_damping"], method=STRONG):
        if number(row, "rate / natural frequency") >= STRONG_DAMPING:
            assert number(row, "error rad") <= 1e-8


def test_the_default_terms_beat_every_grid(tables: run_time.Tables) -> None:
    series = run_time.plate_row(tables, TERMS)
    for row in rows_of(tables["plate"], method="grid", point="at the load"):
        assert number(series, "error") < number(row, "error")
        assert number(series, "ms") < number(row, "ms")


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        *((1689e3, "1,700,000"), (248, "250"), (9.96, "10"), (8.116, "8.1"), (1, "1")),
        *((0.0562, "0.056"), (0.00012, "0.00012"), (1.519e-6, "1.5e-6"), (1e-9, "1e-9")),
    ],
)
def test_figures_are_rounded_to_two_digits(value: float, shown: str) -> None:
    assert rounded(value) == shown
