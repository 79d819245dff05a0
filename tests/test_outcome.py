"""Tests what a report says of rows: how sure figures are, where errors occur, saturation."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tactus.report.draw.outcome import disturbance_plots, predicted_plots
from tactus.report.measure.disturbance import noise_and_drift
from tactus.report.measure.outcome import SURE, Outcome, confidence, outcome, sensors
from tactus.scene import Scene, load_scene


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
