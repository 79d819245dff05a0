"""Tests make activations: its figures, its files, and the documentation of them."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

from golden.activation.schemes import forms
from tactus.report.measure import activation_errors as errors
from tactus.report.measure.activation_errors import (
    FACTORS,
    Row,
    plot_file,
    table,
)

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the command writes, and prints."""
    build = tmp_path_factory.mktemp("build")
    result = subprocess.run(
        [sys.executable, "-m", "tactus.report.measure.activation_errors", "--build", str(build)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert not result.stderr
    (build / "printed").write_text(result.stdout)
    return build


@pytest.fixture(scope="module")
def rows(folder: Path) -> list[Row]:
    written = json.loads((folder / "activations" / "errors.json").read_text())
    assert set(written["versions"]) == {"python", "numpy", "matplotlib"}
    return [Row(**record) for record in written["rows"]]


def at_three(rows: list[Row], scheme: str, arithmetic: str, options: str = "") -> Row:
    return next(
        row
        for row in rows
        if (row.scheme, row.arithmetic, row.options, row.factor) == (scheme, arithmetic, options, 3)
    )


def test_every_form_is_measured_in_all_its_precisions(rows: list[Row]) -> None:
    for name, scheme in forms().items():
        expected = {
            (arithmetic, factor)
            for precision in scheme.precisions
            for factor in (FACTORS if precision.normalise else (1,))
            for arithmetic in ((precision.name, "float") if precision.normalise else ("exact",))
        }
        found = [(r.arithmetic, r.factor) for r in rows if (r.scheme, r.options) == (name, "")]
        assert set(found) == expected
        assert len(found) == len(expected)


def test_which_reading_of_equation_4_32_is_the_thesis(rows: list[Row]) -> None:
    """For every scheme of piecewise curves, twice equation 4.32 is nearer to the printed figure."""
    for name in ("gradient", "gradient_parallel", "polynomial", "lut"):
        row = at_three(rows, name, "float")
        assert abs(row.mean_percent_thesis - row.thesis) < 0.2 * row.thesis
        assert abs(row.mean_percent - row.thesis) > 0.45 * row.thesis
    row = at_three(rows, "pade", "thesis", "rho = 4, iterations = 24")
    assert row.mean_percent < row.mean_percent_thesis < row.thesis == 0.09


def test_the_command_prints_and_draws_what_it_measures(folder: Path, rows: list[Row]) -> None:
    assert (folder / "printed").read_text().startswith("\n".join(table(rows)))
    with (folder / "activations" / "errors.csv").open() as handle:
        assert [r["scheme"] for r in csv.DictReader(handle)] == [r.scheme for r in rows]
    plots = {path.name for path in (folder / "activations").glob("*.svg")}
    assert plots == set(map(plot_file, forms()))


def test_a_scheme_of_our_own_has_no_figure_of_the_thesis() -> None:
    assert errors.thesis_figure("gradient_parallel") == 0.40
    assert errors.thesis_figure("relu") is None
