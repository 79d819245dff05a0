"""Tests networks with past samples: the keys of a scene, which rows it uses, and the twins."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refused import call

from golden.input_error import InputError
from golden.instruments.readout import Readout
from golden.networks.axis_network import AxisNetwork
from golden.networks.network import CHUNK, Network
from golden.networks.windowed import Windowed
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from golden.sensing.frame_window import FrameWindow
from golden.trained.window import Window
from tactus.cli.train import train_scene
from tactus.core.table import read_table, write_table
from tactus.errors import held_out_rows, provenances
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.vectors import read_recorded
from tactus.train.split import split_of
from tactus.train.task import task_for
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of
from tb.common.case_library import PAST
from tb.common.cases import Case

WINDOW = Window(((0, 2, 3), (0,), (1, 5)))
ROWS = (60, 47)
COLUMNS = ("a", "b", "c", "y")
SCENE = """
[data]
recordings = ["one.csv", "two.csv"]
sensors = ["a", "b", "c"]
outputs = ["y"]
full_scale = { y = 1.0 }
window = { a = [0, 2, 3], c = [1, 5] }
[network]
arrangement = "single"
hidden = 3
weights = "past.npz"
[hardware]
design = "engine"
precision = "exact"
[training]
restarts = 1
steps = 20
split = "blocks"
block_rows = 8
"""


@pytest.fixture
def past(tmp_path: Path) -> Scene:
    """An untrained scene with three sensors, two of which have past samples, and two recordings."""
    rng = np.random.default_rng(3)
    for name, rows in zip(("one", "two"), ROWS, strict=True):
        write_table(tmp_path / f"{name}.csv", COLUMNS, rng.uniform(-0.9, 0.9, (rows, 4)), 4)
    path = tmp_path / "past.toml"
    path.write_text(SCENE)
    return load_scene(str(path))


def edited(scene: Scene, old: str, new: str) -> Scene:
    assert old in SCENE
    scene.path.write_text(SCENE.replace(old, new))
    return load_scene(str(scene.path))


@pytest.fixture
def trained(past: Scene, tmp_path: Path) -> Scene:
    train_scene(past, tmp_path / "build", 1)
    return load_scene(str(past.path))


def test_inputs_are_the_samples_of_each_frame_and_of_those_before(past: Scene) -> None:
    vectors, rows = past.vectors(), []
    for path in past.data_paths:
        a, b, c, _ = read_table(path, COLUMNS).T
        rows += [[a[t], b[t], c[t - 1], a[t - 2], a[t - 3], c[t - 5]] for t in range(5, len(a))]
    assert past.inputs == ("a", "b", "c 1 before", "a 2 before", "a 3 before", "c 5 before")
    assert np.array_equal(vectors.inputs, rows)
    assert np.array_equal(vectors.codes, SIGNAL.quantise(vectors.inputs)[0])
    assert [codes.shape for codes in vectors.recordings] == [(rows, 3) for rows in ROWS]
    for codes, path in zip(vectors.recordings, past.data_paths, strict=True):
        assert np.array_equal(codes, SIGNAL.quantise(read_table(path, past.sensors))[0])
    assert len(vectors.targets) == len(vectors.scale) == sum(ROWS) - 2 * 5
    assert vectors.targets[ROWS[0] - 5, 0] == read_table(past.data_paths[1], ["y"])[5, 0]


@pytest.mark.parametrize("split", ["blocks", "groups"])
def test_parts_share_no_sample(past: Scene, split: str) -> None:
    if split == "groups":
        for path in past.data_paths:
            table = read_table(path, COLUMNS)
            day = np.arange(len(table)) // 7
            write_table(path, [*COLUMNS, "day"], np.column_stack([table, day]), 4)
        new = 'split = "groups"\nsplit_by = ["day"]\n'
        past = edited(past, 'split = "blocks"\nblock_rows = 8\n', new)
    recorded, reach = read_recorded(past), past.window.past
    for seed in range(8):
        found = split_of(replace(past, training=replace(past.training, seed=seed)))
        frames: list[set[tuple[int, int]]] = []
        for rows in (found.training, found.validation, found.test):
            ends = zip(recorded.runs[rows], recorded.numbers[rows], strict=True)
            frames.append({(r, n - d) for r, n in ends for d in range(reach + 1)})
        assert not (frames[0] & frames[1])
        assert not (frames[0] & frames[2])
        assert not (frames[1] & frames[2])
        # Only rows at borders are left out.
        assert found.count >= 97 - reach * 15


def test_drift_is_one_for_all_samples_of_a_sensor(past: Scene) -> None:
    own = [tap.sensor for tap in WINDOW.taps]
    given = Disturbance(0.0, 0.1, 0.1).of(np.ones((1, 6)), np.random.default_rng(1), own)[0]
    assert len(set(given.tolist())) == 3
    assert all(len({v for v, s in zip(given, own, strict=True) if s == k}) == 1 for k in range(3))
    vectors = past.vectors()
    still = replace(past.training, disturbance=Disturbance(0.0, 0.0, 0.05))
    task = task_for(replace(past, training=still), vectors, [])
    moved = task.training.codes - np.resize(
        vectors.codes[task.split.training], task.training.codes.shape
    )
    # The samples of a, 2 and 3 frames back. They agree up to rounding, unless a code is at its end.
    whole = (np.abs(task.training.codes) < 8190).all(axis=1)
    assert np.abs(moved[whole, 0] - moved[whole, 3]).max() <= 1 < np.abs(moved[:, 0]).max()
    assert np.abs(moved[whole, 0] - moved[whole, 1]).max() > 100


def test_training_says_what_it_leaves_out_and_provenance_tells_the_window(
    past: Scene, capfd, tmp_path: Path
) -> None:
    train_scene(past, tmp_path / "build", 1)
    trained, said = load_scene(str(past.path)), capfd.readouterr().out
    assert "97 rows; 10 further rows have no whole past and are not used; 40 share samples" in said
    stories = provenances(trained)
    assert stories[0]["data"] == "one.csv, two.csv"
    assert stories[0]["window"] == "a 0 2 3, b 0, c 1 5"
    rows = held_out_rows(trained)
    assert rows.tolist() == split_of(trained).test.tolist()
    other = edited(trained, "a = [0, 2, 3]", "a = [0, 2, 4]")
    assert provenances(other) is None, "trained on other samples"


def test_predictions_of_rows_without_a_whole_past_are_empty(
    trained: Scene, tmp_path: Path, capfd
) -> None:
    source, to = trained.data_paths[0], tmp_path / "out.csv"
    call("predict", trained.path, source, to)
    assert "the first 5 of 60 rows have no whole past and no outputs" in capfd.readouterr().out
    with to.open() as handle:
        rows = list(csv.DictReader(handle))
    assert len(rows) == 60
    assert [(row["y_predicted"], row["outside"], row["reason"]) for row in rows[:5]] == [
        ("", "1", "no whole past")
    ] * 5
    wanted = trained.twin().core.process(trained.vectors().codes[:55])[:, 0]
    found = [float(row["y_predicted"]) for row in rows[5:]]
    assert np.array_equal(np.round(np.array(found) * 8192), wanted)
    write_table(source, COLUMNS, read_table(source, COLUMNS)[:5], 4)
    with pytest.raises(InputError, match=r"one.csv: got 5 rows, expected more than the 5 that"):
        call("predict", trained.path, source, to)


@pytest.mark.parametrize("longest", [46, 47])
def test_a_window_as_long_as_a_recording_is_refused(past: Scene, longest: int) -> None:
    text = SCENE.replace("c = [1, 5]", f"c = [1, {longest}]").replace("= 8", "= 50")
    past.path.write_text(text)
    scene = load_scene(str(past.path))
    if longest == 46:
        assert len(scene.vectors().codes) == 60 + 47 - 2 * 46
        return
    message = r"two.csv: got 47 rows, expected more than the 47 that data.window of .* reaches back"
    with pytest.raises(InputError, match=message):
        scene.vectors()


FMT = Fix(14, 13)


def block(window: Window, slots=0, spacing=100) -> FrameWindow:
    return FrameWindow(FMT, window, slots, spacing)


@pytest.fixture(scope="module")
def windowed(tmp_path_factory: pytest.TempPathFactory) -> Windowed:
    return scene_of(PAST, tmp_path_factory.mktemp("past"), "past").twin()


def random_frames(count: int, sensors: int) -> np.ndarray:
    return np.random.default_rng(1).integers(FMT.low, FMT.high + 1, (count, sensors))


def test_the_network_takes_the_samples_of_the_window(windowed: Windowed) -> None:
    """Frames beyond a chunk have those before it as their past."""
    frames = random_frames(CHUNK + 20, windowed.inputs)
    taps = windowed.frame_window.window.frames(frames)
    results = windowed.process(frames)
    assert results.shape == (len(frames) - windowed.past, windowed.outputs)
    assert windowed.process(frames[: windowed.past]).shape == (0, windowed.outputs)
    assert np.array_equal(results, windowed.network.process(taps))
    assert windowed.core is windowed.network


@pytest.mark.parametrize("around", [AxisNetwork, Readout])
def test_what_stands_around_it_has_its_past(windowed: Windowed, around: type[Network]) -> None:
    network = around(network=windowed)
    frames = random_frames(30, windowed.inputs)
    assert network.past == windowed.past
    assert np.array_equal(network.process(frames), windowed.process(frames))


def test_frames_may_not_follow_faster_than_they_are_sent() -> None:
    window = Window(((0, 1), (0, 1)))
    assert block(window, slots=1, spacing=5).interval == 5
    for slots, spacing in ((1, 4), (0, 0), (-1, 100)):
        with pytest.raises(InputError, match=f"frame_window: got slots={slots} and spacing="):
            block(window, slots, spacing)


def test_an_instrument_leaves_its_engine_the_clocks_of_a_scan(tmp_path) -> None:
    """The engine keeps up with the frames."""
    case: Case = CASES["past-instrument"]
    twin = scene_of(case, tmp_path, "fast").twin()
    assert twin.past == 2
    assert twin.readout.interval <= twin.interval
