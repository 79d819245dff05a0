"""Tests table search_runs: the content of the record."""

from itertools import groupby

import pytest

from tactus.report.draw.findings import search_plot
from tactus.report.measure.search_runs import COLUMNS, SCENES, matrices, row, search_runs

ROWS = search_runs(1).rows


def test_there_is_a_row_for_every_matrix_and_number_of_runs() -> None:
    assert list(search_runs(1).columns) == COLUMNS
    for (name, _), rows in groupby(ROWS, lambda found: found[:2]):
        assert tuple(found[2] for found in rows) == SCENES[name]
    assert {found[0] for found in ROWS} == set(SCENES)


def test_more_runs_never_need_more_bits() -> None:
    for _, rows in groupby(ROWS, lambda found: found[:2]):
        bits = [found[3] for found in rows]
        assert bits == sorted(bits, reverse=True)


# A thousand runs take long.
@pytest.mark.parametrize("number", [0, 1])
def test_a_row_is_what_is_measured(number: int) -> None:
    name, variant, runs, *_ = ROWS[number]
    (matrix,) = (found for found in matrices(name) if found.variant == variant)
    assert COLUMNS[-1] == "CPU s"
    assert row(name, matrix, runs)[:-1] == list(ROWS[number][:-1])


def test_the_plot_shows_what_is_saved() -> None:
    plot = search_plot(search_runs(1))
    assert len(plot.groups) == len(ROWS) // len(SCENES["digit-fast"])
    for (name, variant), rows in groupby(ROWS, lambda found: found[:2]):
        found = list(rows)
        saved = [100 * (1 - row[3] / found[0][3]) for row in found]
        times = [row[4] for row in found]
        assert plot.groups[f"{name}, {variant}"] == list(zip(times, saved, strict=True))
