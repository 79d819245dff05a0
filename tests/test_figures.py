"""make figures: the tables, what they claim, and the files they leave."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from golden.figures.rbf import printed_figures
from golden.figures.registry import TABLES
from golden.figures.table import Table

ROOT = Path(__file__).parents[1]


def run(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "golden.figures", *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    build = tmp_path_factory.mktemp("build")
    result = run("--build", str(build), "--seed", "3")
    assert result.returncode == 0, result.stderr
    return build / "figures", result.stdout


def columns(measured: tuple[Path, str], table: str, *names: str) -> list[list]:
    """Some columns of a table, from the JSON."""
    found = json.loads((measured[0] / "figures.json").read_text())["tables"][table]
    at = [found["columns"].index(name) for name in names]
    return [[row[c] for c in at] for row in found["rows"]]


def test_every_table_is_printed_and_written(measured: tuple[Path, str]) -> None:
    folder, printed = measured
    data = json.loads((folder / "figures.json").read_text())
    assert list(data["tables"]) == list(TABLES)
    assert {p.name for p in folder.iterdir()} == {"figures.json", *(f"{n}.csv" for n in TABLES)}
    for name, table in data["tables"].items():
        assert re.search(rf"^{name}$", printed, re.M)
        with (folder / f"{name}.csv").open(newline="") as handle:
            header, *rows = csv.reader(handle)
        assert header == table["columns"]
        written = [["" if cell is None else str(cell) for cell in row] for row in table["rows"]]
        assert rows == written
        assert table["note"]


def test_the_json_says_what_took_part(measured: tuple[Path, str]) -> None:
    data = json.loads((measured[0] / "figures.json").read_text())
    assert data["seed"] == 3
    assert list(data["versions"]) == ["tactus", "python", "numpy", "scipy"]
    assert all(re.match(r"\d+\.\d+", v) for v in data["versions"].values())
    assert len(data["sources"]) == 64


def test_the_same_seed_gives_the_same_bytes(measured: tuple[Path, str], tmp_path: Path) -> None:
    folder, _ = measured
    assert run("--build", str(tmp_path), "--seed", "3", "operations", "profile").returncode == 0
    again = tmp_path / "figures"
    assert {p.name for p in again.iterdir()} == {"figures.json", "operations.csv", "profile.csv"}
    for name in ("operations.csv", "profile.csv"):
        assert (again / name).read_bytes() == (folder / name).read_bytes()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["clases"], "error: TABLE=clases: no such table, expected one of networks, "),
        (["clases"], "did you mean 'classes'?"),
        (["--seed", "-1", "series"], "error: SEED=-1: expected 0 or more"),
    ],
)
def test_bad_input_leaves_what_was_there(tmp_path: Path, words: list[str], message: str) -> None:
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "old").touch()
    result = run("--build", str(tmp_path), *words)
    assert result.returncode == 2
    assert message in result.stderr
    assert [p.name for p in (tmp_path / "figures").iterdir()] == ["old"]


def test_the_mlp_is_better_than_the_rbf_and_of_the_printed_size(measured) -> None:
    """What section 3.11.3 concludes, on the rows there are; which rows train moves an RBF's largest
    error by a factor of three."""
    found = {
        (network, output): (difference, worst)
        for network, output, difference, worst in columns(
            measured, "classes", "network", "output", "largest difference", "worst start"
        )
    }
    for output, margin in (("load", 1.0), ("position", 1.2)):
        mlp = found["MLP 2:6:2", output][0]
        assert mlp < margin * printed_figures("MLP 2:6:2")[f"{output}_error_max"]
        for network in ("RBF 2:6:2", "RBF 2:7:2"):
            chosen, worst = found[network, output]
            assert mlp < chosen <= worst
            assert chosen < 4 * printed_figures(network)[f"{output}_error_max"]


def test_the_series_converges_but_for_gibbs(measured) -> None:
    for error, bound in columns(measured, "series", "error / d", "bound / d"):
        assert error <= bound
    last = [
        row for row in columns(measured, "series", "terms", "overshoot / d") if row[0] == 100_000
    ]
    assert [overshoot for _, overshoot in last] == pytest.approx([0.08949, 0.08949], abs=2e-5)


def test_the_profile_keeps_its_bound(measured) -> None:
    table = columns(measured, "profile", "frames", "largest units")
    assert len(table) == 12
    bound = max(units for frames, units in table if frames == "every quotient")
    assert bound < 1.81
    assert all(units <= bound for _, units in table)
    assert all(units < 1.2 for frames, units in table if frames.startswith("load"))


def test_a_table_as_text() -> None:
    table = Table("t", ["name", "value"], [["long name", 1.23456], ["x", None], ["y", 12]], "Why.")
    assert table.lines() == [
        "t",
        "",
        "name       value",
        "long name  1.235",
        "x              -",
        "y             12",
        "",
        "Why.",
    ]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (["only one"], "table t: row 1 has 1 cells, expected 2"),
        (["x", float("nan")], "table t: row 1, value: got nan, expected a finite number"),
        (["x", float("inf")], "got inf, expected a finite number, or None"),
    ],
)
def test_a_table_refuses_what_is_no_figure(row, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Table("t", ["name", "value"], [row], "")
