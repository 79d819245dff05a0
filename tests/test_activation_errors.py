"""Tests make activations: its figures, its files, and the documentation of them."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest
from pages import ROUNDING, cells, shows

from golden.activation.schemes import forms
from tactus.report.measure import activation_errors as errors
from tactus.report.measure.activation_errors import (
    FACTORS,
    THESIS_FACTOR,
    Row,
    measure,
    plot_file,
    table,
)

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return measure()


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


def test_the_command_writes_what_it_measures(rows: list[Row], tmp_path: Path) -> None:
    result = subprocess.run(
        [
            *(sys.executable, "-m", "tactus.report.measure.activation_errors"),
            *("--build", str(tmp_path / "build"), "--plots", str(tmp_path / "plots")),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert not result.stderr
    assert result.stdout.startswith("\n".join(table(rows)))
    written = json.loads((tmp_path / "build" / "activations" / "errors.json").read_text())
    assert set(written["versions"]) == {"python", "numpy", "matplotlib"}
    assert [Row(**record) for record in written["rows"]] == rows
    with (tmp_path / "build" / "activations" / "errors.csv").open() as handle:
        assert [r["scheme"] for r in csv.DictReader(handle)] == [r.scheme for r in rows]
    assert {p.name for p in (tmp_path / "plots").iterdir()} == set(map(plot_file, forms()))


def test_the_page_shows_what_the_command_prints(rows: list[Row]) -> None:
    """The words must be equal, and the figures must be those that this machine measures."""
    page = (ROOT / "docs" / "activations.md").read_text()
    lines = table(rows)
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row.scheme, row.options, row.arithmetic), []).append(row)
    figures = lines[4 : 4 + len(groups)]
    for line in set(lines) - set(figures):
        assert f"    {line}".rstrip() + "\n" in page
    for (scheme, options, arithmetic), group in groups.items():
        name = f"{scheme} {'as thesis' if options else ''} {arithmetic}"
        at_three = next((row for row in group if row.factor == THESIS_FACTOR), group[0])
        means = (at_three.mean_percent, at_three.mean_percent_thesis, at_three.thesis)
        found = [*(m for m in means if m is not None), *(row.largest for row in group)]
        for text in (page, "\n".join(lines)):
            for shown, figure in zip(cells(text, *name.split()), found, strict=True):
                assert shows(shown, figure, ROUNDING), name


def test_a_scheme_of_our_own_has_no_figure_of_the_thesis() -> None:
    assert errors.thesis_figure("gradient_parallel") == 0.40
    assert errors.thesis_figure("relu") is None
