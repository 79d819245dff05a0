"""Tests what a report says of rows: how sure figures are, where errors occur, saturation."""

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from tactus.errors.scene_errors import noises_of
from tactus.report.draw.outcome import along_plot, disturbance_plots, predicted_plots
from tactus.report.measure.bounds import bounds, bounds_of
from tactus.report.measure.disturbance import noise_and_drift
from tactus.report.measure.outcome import (
    SURE,
    Outcome,
    along,
    confidence,
    outcome,
    sensors,
    worst_rows,
)
from tactus.report.measure.table import Table
from tactus.scene import Scene, load_scene
from tactus.scene.scale import Scale

SVG = "{http://www.w3.org/2000/svg}"


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


def test_a_constant_sensor_says_nothing_of_neighbours(digit: Outcome) -> None:
    readings = np.column_stack([shuffled(digit).readings, np.ones(143)])
    assert not replace(digit, readings=readings).alike
    assert not replace(digit, readings=np.ones((143, 4))).alike


def test_an_interval_holds_the_mean_as_often_as_it_says(digit: Outcome) -> None:
    """Of 300 samples of 60 about 95 % do, apart from chance and the bias of a small bootstrap."""
    rng = np.random.default_rng(3)
    drawn = np.arange(60)
    held = 0
    for _ in range(300):
        low, high = digit.interval(np.abs(rng.standard_normal(60)), drawn)
        held += low < np.sqrt(2 / np.pi) < high
    assert SURE - 6 < 100 * held / 300 < SURE + 4


def test_errors_that_come_in_stretches_are_less_sure(digit: Outcome) -> None:
    """Ten equal errors in a row count as one, so the interval is wider by the root of ten."""
    errors = np.repeat(np.abs(np.random.default_rng(4).standard_normal(40)), 10)
    low, high = digit.interval(errors, np.arange(400))
    far_low, far_high = digit.interval(errors, np.arange(400) // 10)
    assert (far_high - far_low) / (high - low) == pytest.approx(np.sqrt(10), rel=0.15)


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


def test_every_figure_lies_in_its_interval(digit: Outcome) -> None:
    table = confidence(digit)
    assert len(table.rows) == (4 + len(noises_of(digit.scene))) * 4
    for _, _, _, figure, low, high in table.rows:
        assert low <= figure <= high
        assert low < high


def test_without_positions_and_provenance_only_means_are_left(digit: Outcome) -> None:
    bare = replace(digit, held_out=None, scene=replace(digit.scene, group_by=""))
    noises = [f"mean, noise {noise:g}" for noise in noises_of(digit.scene)]
    kinds = ["mean", *noises, "mean, floating point"]
    assert [row[1] for row in confidence(bare).rows] == kinds * 4
    assert "position" not in worst_rows(bare).columns


def test_means_along_the_positions_make_the_mean(digit: Outcome) -> None:
    table = along(digit)
    counts = np.array([row[1] for row in table.rows])
    means = np.array([row[2:] for row in table.rows])
    assert counts.sum() == 143
    np.testing.assert_allclose(counts @ means / 143, digit.errors.mean(axis=0))


def test_a_position_that_is_no_output_stands_beside_the_worst_rows(digit: Outcome) -> None:
    scene = replace(digit.scene, group_by="place")
    table = worst_rows(replace(digit, scene=scene))
    at = list(table.columns).index("place")
    for row in table.rows:
        assert row[at] == digit.groups[row[1] - 1]


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


def test_what_has_a_scale_stands_in_its_unit(tmp_path: Path) -> None:
    """The same readings in another unit give the same errors, and values in this unit."""
    scene = load_scene("digit-load")
    header, *lines = scene.data_path.read_text().splitlines()
    raw = [
        f"{1000 * float(line.partition(',')[0]) + 50!r},{line.partition(',')[2]}" for line in lines
    ]
    path = tmp_path / "readings.csv"
    path.write_text("\n".join([header, *raw]) + "\n")
    scaled = replace(scene, data_paths=(path,), scale={"sensor1": Scale(50.0, 1000.0)})
    found, plain = outcome(scaled), outcome(scene)
    np.testing.assert_allclose(found.readings[:, 0], 1000 * plain.readings[:, 0] + 50)
    row = sensors(found).rows[0]
    assert row[3:6] == [-950.0, 50 + 1000 * 8191 / 8192, 0]


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
    groups = dict(first.groups)
    assert {label: len(points) for label, points in groups.items()} == {
        "trained or chose": 107,
        "held out": 36,
    }
    pairs = zip(digit.targets[:, 0].tolist(), digit.results[:, 0].tolist(), strict=True)
    assert sorted(point for points in groups.values() for point in points) == sorted(pairs)
    assert digit.held_out is not None
    held = digit.targets[digit.held_out, 0]
    assert sorted(x for x, _ in groups["held out"]) == sorted(held)


def test_of_many_rows_some_are_drawn_and_the_worst_is_one_of_them() -> None:
    found = outcome(load_scene("swing-single"))
    for c, plot in enumerate(predicted_plots(found)):
        points = [point for _, group in plot.groups for point in group]
        assert len(points) in (556, 557)
        worst = int(np.argmax(found.errors[:, c]))
        assert (found.targets[worst, c], found.results[worst, c]) in points
        assert "Every 9th row" in plot.sentence


@pytest.mark.parametrize("name", ["_load", "$load$", "a & b", "<x>", "Kraft in µN"])
def test_any_name_of_a_column_is_drawn(digit: Outcome, name: str) -> None:
    scene = replace(digit.scene, outputs=(name, *digit.scene.outputs[1:]), group_by="$1$ _")
    found = replace(digit, scene=scene)
    drawn = [next(predicted_plots(found)).draw(), along_plot(found, along(found)).draw()]
    for text in drawn:
        words = [element.text for element in ElementTree.fromstring(text).iter(f"{SVG}text")]
        assert any(name in (word or "") for word in words), words
    assert any("$1$ _" in (word or "") for word in words)


def test_what_the_digits_sensors_allow_stands_beside_the_noise() -> None:
    """It is shown for outputs that all readings determine, and not for drift."""
    table = noise_and_drift(load_scene("digit"), 1)
    assert list(table.columns[-2:]) == ["load, bound %", "position, bound %"]
    least = {row[1]: row[4] for row in bounds(1).rows if row[:1] == ["2 mV"] and row[2] == "yes"}
    rows = {(row[0], row[1]): row for row in table.rows}
    assert rows["noise", 0.002][-2:] == pytest.approx([least["load"], least["position"]])
    assert rows["noise", 0.004][-2] == pytest.approx(2 * least["load"])
    assert rows["gain drift", 0.01][-2:] == [None, None]
    noise, gain, _ = disturbance_plots(table)
    assert [label for label in noise.groups if label not in gain.groups] == [
        "load, bound",
        "position, bound",
    ]
    assert noise.looks["load"].colour == noise.looks["load, bound"].colour
    assert "The sensors allow 1.3 % of load" in noise.sentence


@pytest.mark.parametrize("name", ["digit-parallel", "swing-single"])
def test_of_other_sensors_no_bound_is_known(name: str) -> None:
    assert bounds_of(load_scene(name), (0.002,)) == {}


def test_sentences_follow_their_figures(digit: Outcome) -> None:
    columns = ["position", "rows", "load %", "position %", "width %", "shape %"]
    table = Table(
        "along", columns, [[0.1, 1, 1.0, 2.0, 3.0, 4.0], [0.2, 1, 1.0, 9.5, 3.0, 4.0]], ""
    )
    assert along_plot(digit, table).sentence == "The largest is that of position at 0.2, 9.50 %."
    scene = load_scene("digit-load")
    found = noise_and_drift(scene, 1)
    noise, gain, offset = disturbance_plots(found)
    assert [len(plot.groups["load"]) for plot in (noise, gain, offset)] == [6, 6, 6]
    assert noise.groups["load"][0] == gain.groups["load"][0]
    assert noise.groups["load"][-1] == (0.008, found.rows[5][2])
