"""Tests that a channel of noise is named as useless, and no sensor that contributes."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from golden.trained.mlp import Mlp
from tactus.core.finding import OK, WARNING
from tactus.core.fingerprint import ROOT
from tactus.core.table import read_csv_file, read_table, write_table
from tactus.network_files.network_file import write_network
from tactus.report.measure.outcome import telling
from tactus.rig.draft import write_scene
from tactus.rig.sensors_tell import (
    Recording,
    Telling,
    findings,
    measured,
    missed_by_networks,
    recording_of,
    telling_of,
)
from tactus.rig.survey import survey
from tactus.scene import Scene, load_scene
from tactus.train.split import scaled, split_of, split_rows

RAIL = ROOT / "docs" / "tutorial" / "readings.csv"
SENSORS = ("s1", "s2", "s3", "s4", "s5")
OUTPUTS = ("force", "place")


def rail(folder: Path, rows: slice = slice(None), **added: np.ndarray) -> Scene:
    """The rail of the tutorial, with further channels."""
    table = read_table(RAIL, [*SENSORS, *OUTPUTS])
    columns = np.column_stack([*added.values(), table])[rows]
    write_table(folder / "rig.csv", [*added, *SENSORS, *OUTPUTS], columns, 4)
    found = survey(read_csv_file(folder / "rig.csv"), list(OUTPUTS))
    return scaled(write_scene(found, folder / "rig.toml"))


def noise(seed: int, rows: int = 85) -> np.ndarray:
    """The counts of a channel to which nothing is connected."""
    return np.random.default_rng(seed).integers(1987, 2106, rows).astype(float)


@pytest.mark.parametrize("seed", range(3))
def test_a_channel_of_noise_is_named_and_no_other(tmp_path: Path, seed: int) -> None:
    scene = rail(tmp_path, dead=noise(seed))
    warned = {f.subject: f.text for f in findings(scene) if f.verdict == WARNING}
    assert list(warned) == ["dead"]
    assert warned["dead"].startswith("tells nothing")
    assert f"take it out of data.sensors in {scene.path}" in warned["dead"]


def test_what_a_network_misses_tells_something(tmp_path: Path) -> None:
    scene = load_scene("digit-load")
    assert missed_by_networks(scene, scene.sensors) == set(scene.sensors)
    scene = rail(tmp_path, dead=noise(1))
    for path, inputs in zip(scene.weights_paths, (6, 7), strict=True):
        write_network(path, Mlp(np.zeros((1, inputs)), np.zeros(1), np.ones((1, 1)), np.zeros(1)))
    scene = scaled(load_scene(str(scene.path)))
    assert not missed_by_networks(scene, scene.sensors)
    assert not measured(recording_of(scene), split_of(scene), scene.sensors).nothing


@pytest.mark.parametrize("count", [6, 16])
def test_sensors_that_each_tell_a_little_are_not_taken_out_together(count: int) -> None:
    """The class is the sign of their sum. One of six is missed, and some of sixteen together."""
    rows = np.random.default_rng(1).normal(0, 1, (600, count))
    labels = np.where(rows.sum(axis=1, keepdims=True) > 0, 1.0, -1.0)
    names = tuple(f"s{n}" for n in range(count))
    found = measured(Recording(rows, labels, np.ones((600, 1)), names, ("y",)), split_rows(600, 1))
    if count == 6:
        assert not found.nothing
    else:
        assert 0 < len(found.together) < len(found.nothing) < count


def with_noise(scene: Scene, seed: int) -> Telling:
    recording = recording_of(scene)
    more = Recording(
        np.column_stack([recording.readings, noise(seed, len(recording.readings))]),
        recording.targets,
        recording.scale,
        (*recording.sensors, "dead"),
        recording.outputs,
    )
    return measured(more, split_of(scene))


@pytest.mark.parametrize("name", ["digit", "digit-load", "swing-single"])
def test_of_the_shipped_scenes_no_sensor_is_named_but_one_of_noise(name: str) -> None:
    scene = load_scene(name)
    found = telling_of(scene)
    assert found
    assert not found.nothing
    assert min(found.follows.values()) > 0.9
    assert with_noise(scene, 1).nothing == ["dead"]


def test_a_sensor_that_corrects_others_is_not_named(tmp_path: Path) -> None:
    """The example is a temperature that changes every gain but depends on no output."""
    warm = np.random.default_rng(4).uniform(-1, 1, 85)
    table = read_table(RAIL, [*SENSORS, *OUTPUTS])
    scene = rail(tmp_path, warm=warm)
    path = tmp_path / "rig.csv"
    table[:, :5] *= 1 + 0.2 * warm[:, np.newaxis]
    write_table(path, ["warm", *SENSORS, *OUTPUTS], np.column_stack([warm, table]), 4)
    found = telling_of(load_scene(str(scene.path)))
    assert found
    assert found.without["warm"][0] > 2 * found.whole[0]
    assert not found.nothing


def test_where_sensors_tell_nothing_at_all_that_is_said(tmp_path: Path) -> None:
    scene = rail(tmp_path)
    table = read_table(scene.data_path, [*SENSORS, *OUTPUTS])
    table[:, :5] = np.random.default_rng(1).uniform(-1, 1, (85, 5))
    write_table(scene.data_path, [*SENSORS, *OUTPUTS], table, 4)
    told = findings(load_scene(str(scene.path)))
    assert [finding.verdict for finding in told] == [OK, WARNING]
    assert told[1].text.startswith("nothing: with all of them")


def test_make_scene_and_make_check_and_the_report_say_it(tmp_path: Path) -> None:
    scene = rail(tmp_path, dead=noise(1))
    again = tmp_path / "again.toml"
    words = [str(tmp_path / "rig.csv"), ",".join(OUTPUTS), "--to", str(again)]
    for command in (
        ["tactus.cli.scene", *words],
        ["tactus.verify.check", str(scene.path), "--build", str(tmp_path / "build")],
    ):
        done = subprocess.run(
            [sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=True
        )
        assert "warning  dead: tells nothing" in done.stdout
        assert "ok       s1: without it force " in done.stdout
        assert done.stdout.count("tells nothing") == 1
    table = telling(scene)
    assert table
    assert [row[0] for row in table.rows] == ["none", "dead", *SENSORS, "all"]
    assert "dead: tells nothing, take it out" in table.note
