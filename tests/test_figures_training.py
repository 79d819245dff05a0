"""Tests table training: what is the same in every call, and what the pages say of it."""

import numpy as np
import pytest
from pages import SEARCHED, TRAINED, cells, section, shows

from golden.trained.mlp import tanh
from tactus.report.measure import training
from tactus.report.measure.table import Table
from tactus.scene import load_scene
from tactus.train.descent.objective import Objective, Rows, pack
from tactus.train.descent.search import measure, starting_weights
from tactus.train.descent.task import task_for


@pytest.fixture(scope="module")
def table(measured_tables: dict[str, Table]) -> Table:
    return measured_tables["training"]


def rows_of(table: Table, method: str) -> list[tuple]:
    return [tuple(row[1:]) for row in table.rows if row[0] == method]


def test_the_methods(table: Table) -> None:
    assert list(dict.fromkeys(row[0] for row in table.rows)) == [
        *training.STEPS,
        *training.CASCADES,
    ]
    for method in training.STEPS:
        assert {row[1] for row in rows_of(table, method)} == set(range(training.RESTARTS))
    outputs = load_scene("comparison/thesis-larger").outputs
    for method in training.CASCADES:
        expected = [(name, r) for name in outputs for r in range(training.CASCADE_RESTARTS)]
        assert [row[:2] for row in rows_of(table, method)] == expected


def test_times_and_evaluations_grow_along_a_descent(table: Table) -> None:
    for method in training.STEPS:
        for restart in range(training.RESTARTS):
            steps = [row[2:4] for row in rows_of(table, method) if row[1] == restart]
            assert len(steps) > 12
            assert steps == sorted(steps, key=lambda step: step[0])
            assert steps == sorted(steps, key=lambda step: step[1])


def test_both_optimisers_begin_at_the_same_points(table: Table) -> None:
    first = [
        [row[-2:] for row in rows_of(table, method) if row[2] == 1] for method in training.STEPS
    ]
    assert first[0] == first[1]
    assert len(first[0]) == training.RESTARTS


def ends(table: Table, method: str) -> dict[int, float]:
    """The validation error at the end of each start."""
    return {row[1]: row[-2] for row in rows_of(table, method)}


def test_levenberg_marquardt_ends_lower(table: Table) -> None:
    """The best of three starts at 0.22 of the other's error, whatever rounds; and all together."""
    levenberg_marquardt, scg = (ends(table, method).values() for method in training.STEPS)
    assert min(levenberg_marquardt) < 0.5 * min(scg)
    assert sum(levenberg_marquardt) < sum(scg)


def test_the_first_network_of_both_cascades_is_the_same(table: Table) -> None:
    first, second = (
        [row[:3] + row[4:] for row in rows_of(table, method) if row[0] == "load"]
        for method in training.CASCADES
    )
    assert first == second


def test_the_page_shows_where_they_end(table: Table) -> None:
    """The page shows ranges, because a last bit can lead a descent to another minimum."""
    page = section("run-time-tables", "Optimisers")
    for method in training.STEPS:
        shown, *cell = cells(page, method)
        evaluations = max(row[2] for row in rows_of(table, method))
        assert shows(shown, evaluations, SEARCHED)
        for text, error in zip(cell, ends(table, method).values(), strict=True):
            assert shows(text, error, TRAINED), method
    for method in training.CASCADES:
        best: dict[str, float] = {}
        for output, *_, validation, _ in rows_of(table, method):
            best[output] = min(validation, best.get(output, np.inf))
        for text, error in zip(cells(page, method), best.values(), strict=True):
            assert shows(text, error, TRAINED), method


def test_a_candidate_is_that_of_make_train(table: Table) -> None:
    scene = load_scene("comparison/thesis-larger")
    task = task_for(scene, scene.vectors(), [])
    known = measure(task, scene.mlps()[0].shape[1], 2)
    (row,) = [row for row in rows_of(table, "cascade B") if row[:2] == ("load", 2)]
    assert row[-2:] == (known.validation, known.test)


def test_all_but_the_times_is_the_same_again(monkeypatch) -> None:
    monkeypatch.setattr(training, "RESTARTS", 1)
    monkeypatch.setattr(training, "CASCADE_RESTARTS", 1)
    monkeypatch.setattr(training, "STEPS", {"levenberg-marquardt": 20, "scg": 40})
    first, second = training.training(2), training.training(2)
    assert first.without_times() == second.without_times()
    assert "CPU s" not in first.without_times().columns
    assert first.without_times() != training.training(3).without_times()


def test_watching_changes_nothing() -> None:
    rng = np.random.default_rng(1)
    rows = Rows(rng.uniform(-1, 1, (20, 2)), rng.uniform(-1, 1, (20, 1)), np.ones((20, 1)))
    start = pack(starting_weights((2, 3, 1), rng))
    plain, watched = (
        kind((2, 3, 1), tanh, rows, rows, 1e-4, 40) for kind in (Objective, training.Watched)
    )

    def descend(objective: Objective, point, steps: int):
        for n in range(steps):
            objective.residuals(point * (1 + n / 100))
        return point

    assert np.array_equal(plain.search(descend, start, 50), watched.search(descend, start, 50))
    assert watched.evaluations == 50
    assert [note[0] for note in watched.notes] == [*sorted(n for n in training.LOOKS if n < 50), 50]
