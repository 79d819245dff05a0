"""Tests what reports say: how sure figures are, where errors occur, and the scenes side by side."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pages import ROUNDING, shows

from tactus.errors import held_out_means, scene_errors
from tactus.report.draw.outcome import disturbance_plots, predicted_plots
from tactus.report.measure.disturbance import noise_and_drift
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.outcome import SURE, Outcome, confidence, outcome, sensors
from tactus.report.page.side_by_side import side_by_side
from tactus.scene import DEFAULT_SCENES, Scene, load_scene, thesis_table
from tactus.verify.benches.tools import SIMULATORS


@pytest.fixture(scope="module")
def digit() -> Outcome:
    """The outcome of scene digit, as if every fourth row were held out."""
    return replace(outcome(load_scene("digit")), held_out=np.arange(0, 143, 4))


def shuffled(found: Outcome) -> Outcome:
    order = np.random.default_rng(1).permutation(len(found.errors))
    return replace(found, readings=found.readings[order], errors=found.errors[order])


def test_neighbours_along_the_beam_are_alike_and_those_of_a_shuffled_file_are_not(
    digit: Outcome,
) -> None:
    assert digit.alike
    assert digit.stretches.max() == 19
    assert (np.diff(digit.stretches) >= 0).all()
    single = shuffled(digit)
    assert not single.alike
    assert single.stretches.tolist() == list(range(143))


def test_an_interval_holds_the_mean_as_often_as_it_says(digit: Outcome) -> None:
    """Of 300 samples of 60 about 95 % do, apart from chance and the bias of a small bootstrap."""
    rng = np.random.default_rng(3)
    drawn = np.arange(60)
    held = 0
    for _ in range(300):
        low, high = digit.interval(np.abs(rng.standard_normal(60)), drawn)
        held += low < np.sqrt(2 / np.pi) < high
    assert SURE - 6 < 100 * held / 300 < SURE + 4


@pytest.mark.parametrize(("split", "drawn"), [("groups", 3), ("blocks", 4)])
def test_what_was_held_out_as_a_whole_is_drawn_as_a_whole(
    digit: Outcome, split: str, drawn: int
) -> None:
    """The held-out rows are those of three loads, or four stretches of rows."""
    targets = digit.targets[:, 0]
    held = np.flatnonzero(np.isin(targets, np.unique(targets)[:3]))
    if split == "blocks":
        held = np.array([3, 4, 5, 9, 10, 20, 22])
    training = replace(digit.scene.training, split=split, split_by=("load",))
    found = replace(digit, held_out=held, scene=replace(digit.scene, training=training))
    members = found.held_together
    assert len(np.unique(members)) == drawn
    if split == "groups":
        assert len(np.unique(np.column_stack([members, targets[held]]), axis=0)) == drawn
    table = confidence(found)
    assert f"{drawn} in all" in table.note
    row = next(row for row in table.rows if row[1] == "mean, held out")
    assert tuple(row[4:]) == found.interval(digit.errors[held, 0], members)


def scene_with(readings: list[float], folder: Path) -> Scene:
    """The scene digit-load with these readings of the first sensor in the first rows."""
    scene = load_scene("digit-load")
    header, *lines = scene.data_path.read_text().splitlines()
    for n, reading in enumerate(readings):
        lines[n] = f"{reading}," + lines[n].partition(",")[2]
    path = folder / "readings.csv"
    path.write_text("\n".join([header, *lines]) + "\n")
    return replace(scene, data_paths=(path,))


def test_readings_outside_the_range_are_counted_per_sensor(tmp_path: Path) -> None:
    table = sensors(outcome(scene_with([1.5, -1.2, 1.2, 1.5], tmp_path)))
    first, *others = table.rows
    assert first[:6] == ["sensor1", -1.2, 1.5, -1.0, 8191 / 8192, 4]
    assert first[6] == pytest.approx(100 * 4 / 143)
    assert first[7] == 3
    assert [row[5] for row in others] == [0, 0, 0]


def test_rows_that_the_scene_leaves_out_keep_their_numbers() -> None:
    scene = load_scene("digit-parallel")
    found = outcome(scene)
    assert len(found.numbers) < found.numbers.max()
    lines = scene.data_path.read_text().splitlines()
    header = lines[0].split(",")
    at = [header.index(name) for name in scene.sensors]
    for number, readings in zip(found.numbers, found.readings, strict=True):
        cells = lines[number].split(",")
        assert [float(cells[c]) for c in at] == readings.tolist()


def test_the_plots_hold_what_the_tables_hold(digit: Outcome) -> None:
    (first, *_) = predicted_plots(digit)
    groups = {label: list(map(tuple, pairs.T.tolist())) for label, pairs in first.groups.items()}
    assert {label: len(points) for label, points in groups.items()} == {
        "trained or chose": 107,
        "held out": 36,
    }
    pairs = zip(digit.targets[:, 0].tolist(), digit.results[:, 0].tolist(), strict=True)
    assert sorted(point for points in groups.values() for point in points) == sorted(pairs)
    assert digit.held_out is not None
    held = digit.targets[digit.held_out, 0]
    assert sorted(x for x, _ in groups["held out"]) == sorted(held)


def test_the_plots_of_disturbances_hold_what_their_table_holds() -> None:
    table = noise_and_drift(load_scene("digit"), 1)
    noise, gain, offset = disturbance_plots(table)
    rows = {(row[0], row[1]): row for row in table.rows}
    assert noise.groups.keys() == gain.groups.keys() == offset.groups.keys()
    for plot, kind in ((noise, "noise"), (gain, "gain drift"), (offset, "offset drift")):
        (_, recorded), *points = plot.groups["load"]
        assert recorded == rows["as recorded", 0.0][2]
        assert points == [(size, row[2]) for (one, size), row in rows.items() if one == kind]


@pytest.fixture(scope="module")
def scenes() -> list[Scene]:
    return [load_scene(name) for name in DEFAULT_SCENES]


@pytest.fixture(scope="module")
def table(scenes: list[Scene]) -> list[str]:
    return side_by_side(scenes)


def found(scene: Scene, **others: Any) -> dict[str, Any]:
    """Possible results of the benches."""
    facts = {"clocks_per_frame": 12345, "interval": 54321, "frames": 10, "seconds": 2.0}
    blocks = {"abs_unit": {simulator: [1, 70] for simulator in SIMULATORS}}
    results = {
        "benches": 9,
        "kept": 0,
        "left": 0,
        "recorded": [],
        "short": "",
        "failed": 0,
        "compared": 987654,
    }
    own = {"facts": dict.fromkeys(SIMULATORS, facts), "blocks": blocks}
    return results | own | others


def row(table: list[str], name: str) -> str:
    """The text after the first cell of the line with this name."""
    (line,) = [line for line in table if line.strip().startswith(name + "  ")]
    return line.strip().removeprefix(name)


def test_errors_are_those_of_the_scenes_and_of_the_thesis(
    scenes: list[Scene], table: list[str]
) -> None:
    printed = thesis_table("digit.cascade_b")["simulation"]
    for n, name in enumerate(scenes[0].outputs):
        figures = [printed[n]]
        for scene in scenes:
            error, held_out = scene_errors(scene)["bit-true"][n], held_out_means(scene)
            assert held_out is not None
            figures += [error.mean, error.largest_mean, held_out[n]]
        cells = row(table, name).split()
        for text, figure in zip(cells, figures, strict=True):
            assert shows(text, figure, ROUNDING), name


def test_clocks_are_those_of_the_twins_or_those_that_were_simulated(
    scenes: list[Scene], table: list[str]
) -> None:
    counts = [f"{clocks_per_frame(scene.twin()):,}" for scene in scenes]
    assert row(table, "clocks a frame").split() == ["-", *counts]
    board = thesis_table("board")
    first, *others = row(table, "clocks between frames").replace(" us)", "us)").split()[::2]
    assert first == f"{2 ** board['scan_counter_bits']:,}"
    assert others == [f"{scene.twin().interval:,}" for scene in scenes]
    simulated = side_by_side(scenes, {scene.name: found(scene) for scene in scenes})
    assert row(simulated, "clocks a frame").split() == ["-", "12,345", "12,345"]
    assert row(simulated, "clocks between frames").count("54,321") == len(scenes)


def test_what_was_compared_is_told_where_benches_ran(scenes: list[Scene], table: list[str]) -> None:
    assert not any("values compared" in line for line in table)
    results = {scene.name: found(scene) for scene in scenes}
    results[scenes[1].name] = found(scenes[1], failed=3)
    told = row(side_by_side(scenes, results), "values compared")
    assert "987,654, none differ" in told
    assert "987,654, 3 benches red" in told
