"""Tests table digits: the content of the record, and how it is measured."""

from dataclasses import replace

import numpy as np
import pytest

from tactus.report.draw.findings import digits_plot
from tactus.report.measure import digits
from tactus.scene import Scene
from tactus.train.descent import few_digits
from tactus.train.descent.stages import Stages


def test_the_record_has_fewer_digits_in_each_row_and_none_more_than_asked_for() -> None:
    table = digits.digits(1)
    asked, kept = ([row[c] for row in table.rows] for c in (0, 1))
    assert list(table.columns) == digits.columns(digits.load_scene(digits.SCENE))
    assert asked == [count for count in digits.COUNTS if count in asked]
    assert len(asked) >= 3
    assert asked[0] == 0
    assert kept == sorted(kept, reverse=True)
    assert all(count <= most for most, count in zip(asked[1:], kept[1:], strict=True))
    assert list(table.rows[0][2:7]) == [1, 1, 1, 1, 0]


def test_fewer_digits_take_fewer_luts_where_each_weight_has_its_products() -> None:
    table = digits.digits(1)
    at = table.columns.index("parallel LUT")
    luts = [row[at] for row in table.rows if row[at] is not None]
    assert luts == sorted(luts, reverse=True)
    assert len(luts) > 1
    folded = [table.columns.index(f"{name} LUT") for name in digits.FOLDED]
    for row in table.rows:
        measured = [row[c] is not None for c in folded]
        assert all(measured) == any(measured) == (row[0] in digits.FOLDED_COUNTS)


def test_the_plot_shows_the_designs_in_which_digits_save_luts() -> None:
    table = digits.digits(1)
    plot = digits_plot(table)
    assert "parallel" in plot.groups
    assert not set(digits.FOLDED) & set(plot.groups)
    at = table.columns.index("parallel LUT")
    rows = [row for row in table.rows if row[at] is not None]
    for (luts, error), row in zip(plot.groups["parallel"], rows, strict=True):
        assert luts == row[at]
        assert error == pytest.approx(np.mean(row[2:6]))


def test_a_row_is_measured_of_networks_with_so_many_digits(
    small_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cells are not counted here, because that takes minutes."""
    for name, value in {"STARTS": 2, "TEACHER_FRAMES": 100, "REFITS": 3}.items():
        monkeypatch.setattr(few_digits, name, value)
    built = []

    def counted(scene: Scene, design: str, mlp) -> dict[str, int]:
        built.append((design, few_digits.count_digits(mlp, 18)))
        return {"LUT": 7, "multiplier": 3}

    monkeypatch.setattr(digits, "cells_of", counted)
    scene = replace(small_scene, training=replace(small_scene.training, refit=True, digits=40))
    plain = replace(scene, training=replace(scene.training, digits=0))
    stages = Stages(plain)
    stages.add(5, 0)
    row = dict(zip(digits.columns(scene), digits.measured(scene, stages, 40), strict=True))
    assert row["asked"] == 40
    assert row["digits"] <= 40
    assert built == [(name, row["digits"]) for name in ("parallel", "adder_graph")]
    assert (row["parallel LUT"], row["parallel multiplier"], row["hybrid LUT"]) == (7, 3, None)
    whole = dict(zip(digits.columns(scene), digits.measured(scene, stages, 0), strict=True))
    assert whole["digits"] > 40
    assert [whole[name] for name in (*scene.outputs, "deviation")] == [1, 1, 0]
    assert [design for design, _ in built[2:]] == list(digits.FORMS)
