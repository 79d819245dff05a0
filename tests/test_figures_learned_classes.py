"""Tests the table learned_classes, and how it is measured."""

from dataclasses import replace

import numpy as np
import pytest

from golden.scene.labels import one_hot
from golden.training.objective import Rows
from tb.report.measure import learned_classes, table_records
from tb.report.measure.learned_classes import STUDIES, best, functions, mlp, task_of, wrong
from tb.report.page import learned

WINE = STUDIES[0]


class Fixed:
    """Gives the same logits whatever the inputs are."""

    def __init__(self, *logits: list[float]) -> None:
        self.logits = np.array(logits)

    def process(self, frames: np.ndarray) -> np.ndarray:
        return self.logits


@pytest.fixture(scope="module")
def rows() -> dict[tuple[str, str], dict[str, object]]:
    table = table_records.read("learned_classes")
    return {
        (str(row[0]), str(row[1])): dict(zip(table.columns, row, strict=True)) for row in table.rows
    }


def test_each_scene_has_its_networks_and_splits(rows) -> None:
    expected = []
    for study in STUDIES:
        names = [f"{study.kind}, {n} sums{text}" for n in study.sums for text in ("", ", pruned")]
        expected += [(study.scene, name) for name in ("MLP", *names)]
    assert list(rows) == expected
    for (scene, _), row in rows.items():
        study = next(one for one in STUDIES if one.scene == scene)
        found = [row[f"wrong {n + 1}"] for n in range(learned_classes.SEEDS)]
        counts = [count for count in found if count is not None]
        assert len(counts) == study.seeds
        assert row["wrong %"] == pytest.approx(100 * sum(counts) / row["held-out rows"])
        assert (row["in tables %"] is not None) == (row["network"] != "MLP")


def test_pruning_leaves_fewer_curves(rows) -> None:
    for study in STUDIES:
        for sums in study.sums:
            whole, less = (
                rows[study.scene, f"{study.kind}, {sums} sums{text}"] for text in ("", ", pruned")
            )
            assert (whole["straight"] == 0) == (study.intervals > 0)
            assert less["curved"] < whole["curved"]
            assert less["parameters"] < whole["parameters"]


def test_the_page_shows_every_split(rows) -> None:
    lines = learned.classes(table_records.read("learned_classes")).splitlines()
    assert len(lines) == len(rows) + 2
    splits = [line.split(" | ")[7].split(", ") for line in lines[2:]]
    assert [len(found) for found in splits] == [
        next(one.seeds for one in STUDIES if one.scene == scene) for scene, _ in rows
    ]


def test_fewest_wrong_decisions_choose_and_then_the_cross_entropy() -> None:
    targets = one_hot(["a", "b"], ["a", "b"])
    given = Rows(np.zeros((2, 1)), targets, np.ones_like(targets))
    sure, unsure = Fixed([3.0, 0.0], [0.0, 3.0]), Fixed([1.0, 0.0], [0.0, 1.0])
    mistaken = Fixed([9.0, 0.0], [0.1, 0.0])
    assert [wrong(one, given) for one in (sure, unsure, mistaken)] == [0, 0, 1]
    assert best([mistaken, unsure, sure], given) is sure
    assert best([mistaken, unsure], given) is unsure


def test_a_split_is_measured_as_it_was_recorded(rows) -> None:
    """With fewer candidates, which is quicker; the last bits of others may choose another one."""
    few = replace(WINE, candidates=3)
    found = [mlp(few, 1), *functions(few, 2, 1)]
    held_out = sum(len(task_of(WINE, 1 + n).test.inputs) for n in range(WINE.seeds))
    names = ("MLP", "functions, 2 sums", "functions, 2 sums, pruned")
    for one, name in zip(found, names, strict=True):
        row = rows[WINE.scene, name]
        assert row["held-out rows"] == held_out
        assert one.rows == len(task_of(WINE, 1).test.inputs)
        assert abs(one.wrong - row["wrong 1"]) <= 3
    assert found[0].parameters == rows[WINE.scene, "MLP"]["parameters"]
    assert found[1].parameters == rows[WINE.scene, "functions, 2 sums"]["parameters"]


def test_a_record_is_stale_if_the_data_of_a_scene_change(monkeypatch: pytest.MonkeyPatch) -> None:
    before = table_records.state("learned_classes")
    monkeypatch.setitem(table_records.OF_SCENES, "learned_classes", ("classes/digits",))
    assert table_records.state("learned_classes") != before
