"""Tests make scene: what it says of readings, and the scene that it writes."""

import subprocess
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from shared import CALL, run

from golden.input_error import InputError
from golden.trained.dense import mlp_of, network_of
from tactus.core.finding import OK, WARNING
from tactus.core.table import read_csv_file, read_table, write_table
from tactus.network_files.network_file import save_network, save_networks, write_network
from tactus.report.measure.outcome import telling
from tactus.rig.draft import brought, draft, names_of, write_scene
from tactus.rig.sensors_tell import (
    Recording,
    findings,
    measured,
    missed_by_networks,
    recording_of,
    telling_of,
)
from tactus.rig.survey import Survey, survey
from tactus.scene import Scene, load_scene
from tactus.scene.codes import saturating as scene_saturating
from tactus.train.split import scaled, split_of, split_rows
from tb.common.cases import random_mlp, random_network

ROOT = Path(__file__).parents[1]
RNG = np.random.default_rng(3)
PLACE = RNG.uniform(0.1, 0.9, 60)
FORCE = RNG.choice([0.2, 0.4, 0.6], 60)
# Readings of three sensors with force and place, without faults.
TABLE = {
    **{
        f"s{k}": FORCE * np.exp(-(((PLACE - at) / 0.3) ** 2)) + RNG.normal(0, 0.002, 60)
        for k, at in enumerate((0.1, 0.5, 0.9), start=1)
    },
    "force": FORCE,
    "place": PLACE,
}


def text_of(table: dict[str, object], sign: str = ",", point: str = ".") -> str:
    """The text of a CSV."""
    names = [f'"{name}"' if "," in name else name for name in table]
    lines = [sign.join(names)]
    for row in zip(*table.values(), strict=True):
        cells = (cell if isinstance(cell, str) else f"{cell:.4f}" for cell in row)
        lines.append(sign.join(cell.replace(".", point) for cell in cells))
    return "\n".join(lines) + "\n"


NETWORKS = {
    "tanh.npz": random_network((3, 4, 2), ("tanh",), 1.0, 1),
    "relu.onnx": random_network((3, 6, 4, 2), ("relu", "sigmoid"), 1.0, 1),
}


@pytest.mark.parametrize("times", [1, 20])
@pytest.mark.parametrize("name", NETWORKS)
def test_a_scene_for_a_network_from_elsewhere(tmp_path: Path, name: str, times: int) -> None:
    """It computes what the file does, whatever the range of the readings."""
    network, file = NETWORKS[name], tmp_path / "nets" / name
    file.parent.mkdir()
    layers = list(network.layers)
    layers[0] = replace(layers[0], weights=layers[0].weights / times)
    write_network(file, network_of(layers))
    sensors = {key: times * np.asarray(TABLE[key]) for key in ("s1", "s2", "s3")}
    results = network.process(np.column_stack([TABLE[key] for key in sensors]))
    found = look(tmp_path, **sensors, force=results[:, 0], place=results[:, 1])
    path = tmp_path / "mine.toml"
    scene = write_scene(found, path, network=brought(file, found))
    assert scene.describe() == ":".join(map(str, network.shape))
    assert scene.arrangement == "single"
    assert [member.weights_path for member in scene.members] == [file]
    text = path.read_text()
    kinds = [layer.activation for layer in layers[:-1]]
    assert tomllib.loads(text)["network"]["activations"] == kinds
    assert "[training]" not in text
    assert ("FILL IN the ranges of your converter" in text) == (
        times > 1 or np.abs(results).max() > 1
    )
    vectors = scene.vectors()
    real = scene.in_units(scene.process_real(vectors.inputs))
    assert np.abs(real - results).max() < 0.01
    assert not scene_saturating(scene)
    bit_true = scene.outputs_in_units(scene.twin().process(vectors.codes))
    assert np.abs(bit_true - results).max() < 0.02


def look(folder: Path, outputs: str = "force,place", **changed: object) -> Survey:
    """The survey of the readings, with some columns changed or added."""
    path = folder / "rig.csv"
    path.write_text(text_of(TABLE | changed), encoding="utf-8")
    return survey(read_csv_file(path), names_of(outputs))


def halves() -> dict[str, object]:
    """Columns in which every second row is the mean of its neighbours."""
    changed = {}
    for name in ("s1", "s2", "s3"):
        values = TABLE[name].round(3)
        values[1:-1:2] = (values[:-2:2] + values[2::2]) / 2
        changed[name] = values
    return changed


def test_interpolated_rows_are_named_and_held_out_in_blocks(tmp_path: Path) -> None:
    """What else the readings show, ``make check`` says of the scene that is written."""
    (finding,) = look(tmp_path, **halves()).findings
    assert finding.verdict == WARNING
    assert "29 of 60 rows are exact means of the rows beside them" in finding.text
    words = ["tactus.cli.scene", tmp_path / "rig.csv", "force,place"]
    assert str(finding) in run(*CALL, *words, DRY="1").stdout
    assert scene_of(tmp_path, **halves()).training.split == "blocks"


@pytest.mark.parametrize(
    ("column", "why"),
    [
        (["x"] * 60, "no numbers, line 2 holds 'x'"),
        ([""] * 60, "no numbers, line 2 holds ''"),
        (np.full(60, 0.5), "0.5 in every row"),
        (np.arange(60.0), "counts the rows"),
        (np.arange(60) / 100 + 7, "counts the rows"),
        (np.arange(60) / 200 + 1.7e9, "counts the rows"),
        ([f"{row / 60:.10f}" for row in range(60)], "counts the rows"),
        (0.25 - 0.5 * TABLE["s2"].round(4), "repeats the sensor 's2', perhaps in another unit"),
        (PLACE.round(4) * 0.5, "repeats the output 'place', perhaps in another unit"),
    ],
)
def test_columns_that_are_no_sensors_are_left_out(tmp_path: Path, column, why: str) -> None:
    found = look(tmp_path, more=column)
    assert found.left_out == {"more": why}
    assert "more" not in found.sensors


def test_readings_in_farads_do_not_count_rows(tmp_path: Path) -> None:
    found = look(tmp_path, more=[f"{value:.5e}" for value in 1e-12 * RNG.uniform(1, 2, 60)])
    assert "more" in found.sensors


def test_a_refused_scene_is_named_as_it_would_be_written(tmp_path: Path) -> None:
    found = look(tmp_path, more=[f"{value:.5e}" for value in 1e300 * RNG.uniform(1, 2, 60)])
    with pytest.raises(InputError, match=rf"for data.scale.more in {tmp_path / 'mine.toml'}$"):
        write_scene(found, tmp_path / "mine.toml")


@pytest.mark.parametrize(("sessions", "grouped", "split"), [(6, 1, 1), (2, 1, 1), (60, 0, 0)])
def test_sessions_that_have_names_are_held_out_whole(
    tmp_path: Path, sessions: int, grouped: bool, split: bool
) -> None:
    found = look(tmp_path, day=[f"day {row * sessions // 60}" for row in range(60)])
    text = draft(found, tmp_path / "mine.toml")
    assert ('group_by = "day"' in text) == grouped
    assert ('split = "groups"\nsplit_by = ["day"]' in text) == split


@pytest.mark.parametrize(("sign", "point"), [(";", "."), (";", ","), ("\t", "."), ("\t", ",")])
def test_the_command_that_it_names_mends_the_file(tmp_path: Path, sign: str, point: str) -> None:
    (tmp_path / "my rig.csv").write_text(text_of(TABLE, sign, point))
    with pytest.raises(InputError, match="converts it") as refused:
        read_csv_file(tmp_path / "my rig.csv")
    command = str(refused.value).rpartition("; ")[2].removesuffix(" converts it")
    subprocess.run(command, shell=True, cwd=tmp_path, check=True)
    assert (tmp_path / "comma.csv").read_text() == text_of(TABLE)


def scene_of(folder: Path, outputs: str = "force,place", **changed: object) -> Scene:
    return write_scene(look(folder, outputs, **changed), folder / "my-rig.toml")


def test_the_scene_is_what_the_readings_ask_for(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, number=np.arange(60))
    assert scene.sensors == ("s1", "s2", "s3")
    assert scene.outputs == ("force", "place")
    assert scene.arrangement == "cascade"
    assert scene.group_by == "force"
    assert scene.full_scale == {"force": 0.4, "place": pytest.approx(np.ptp(PLACE), abs=1e-4)}
    assert scene.weights_paths == [tmp_path / "my-rig.npz" / name for name in scene.outputs]
    assert scene.data_path == tmp_path / "rig.csv"
    text = scene.path.read_text()
    assert "# Left out: number, counts the rows.\n" in text
    assert "no target is 0" in text


def test_raw_units_are_scaled(tmp_path: Path) -> None:
    """This holds for any column beyond the codes, of a sensor or of an output."""
    assert not scene_of(tmp_path).scale
    for folder, changed in (("a", {"s2": TABLE["s2"] * 4095}), ("b", {"place": PLACE * 300})):
        (tmp_path / folder).mkdir()
        scene = scene_of(tmp_path / folder, **changed)
        assert set(scene.scale.values()) == {"auto"}
        assert scaled(scene).vectors().codes.shape == (60, 3)


@pytest.mark.parametrize(
    ("unit", "decimals", "noise"),
    [(1, 4, 0.002), (1, 2, 0.01), (1000, 4, 0.6), (4095, 0, 2), (300, 0, 1), (1e7, 0, 100)],
)
def test_the_noise_that_it_names_is_one_of_such_readings(
    tmp_path: Path, unit: float, decimals: int, noise: float
) -> None:
    """It is in their unit, at least their last decimal, and within the range of a scene."""
    sensors = {name: (TABLE[name] * unit).round(decimals) for name in ("s1", "s2", "s3")}
    path = scene_of(tmp_path, **sensors).path
    text = path.read_text()
    assert f"\n# noise = {noise:g}\n" in text
    path.write_text(text.replace("# noise = ", "noise = "))
    assert load_scene(str(path)).training.disturbance.noise == noise


AWKWARD = ["Kraft, N", "a'b", "läge (mm)", "a\\b", "# no comment", "]", "a = 1", "日本"]


def test_awkward_names_stay_what_they_are(tmp_path: Path) -> None:
    outputs = {name: RNG.uniform(0.1, 0.9, 60) for name in AWKWARD}
    sensors = {f"s {name}": RNG.uniform(-0.9, 0.9, 60) for name in AWKWARD}
    words = ",".join(f'"{name}"' if "," in name else name for name in AWKWARD)
    scene = scene_of(tmp_path, words, **outputs, **sensors)
    assert scene.outputs == tuple(AWKWARD)
    assert set(sensors) < set(scene.sensors)
    assert set(scene.full_scale) == set(AWKWARD)
    networks = [random_mlp((one.inputs, 2, 1), 1.0, n) for n, one in enumerate(scene.members)]
    save_networks([(p, mlp, {}) for p, mlp in zip(scene.weights_paths, networks, strict=True)])
    for member, mlp in zip(scene.members, networks, strict=True):
        assert np.array_equal(member.load().layers[0].weights, mlp.layers[0].weights)
    assert {file.name for file in scene.network_files} == {"my-rig.npz"}


def test_the_command_says_what_it_saw_and_writes(tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    path.write_text(text_of(TABLE | {"who": ["me"] * 60, "s3": TABLE["s3"] / 100}))
    done = run(*CALL, "tactus.cli.scene", path, "force, place")
    assert done.returncode == 0, done.stderr
    assert f"{path}: 60 rows, 6 columns" in done.stdout
    assert "  who    left out  no numbers, line 2 holds 'me'" in done.stdout
    assert done.stdout.count("\nwarning  s3: moves over ") == 1
    assert f"wrote {tmp_path / 'rig.toml'}: 2 networks in cascade, 3 sensors" in done.stdout
    assert read_table(path, ["s1"]).shape == (60, 1)


@pytest.mark.parametrize("mark", ["\ufeff", "\n\n"])
def test_a_mark_and_empty_lines_do_no_harm(tmp_path: Path, mark: str) -> None:
    (tmp_path / "rig.csv").write_text(mark + text_of(TABLE) + "\n,,,,\n", encoding="utf-8")
    recording = read_csv_file(tmp_path / "rig.csv")
    assert recording.names == tuple(TABLE)
    assert len(recording.rows) == 60


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
        nothing = mlp_of(np.zeros((1, inputs)), np.zeros(1), np.ones((1, 1)), np.zeros(1))
        save_network(path, nothing, {})
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


@pytest.mark.parametrize("name", ["digit", "digit-load", "swing-single"])
def test_of_the_shipped_scenes_no_sensor_is_named_but_one_of_noise(name: str) -> None:
    scene = load_scene(name)
    found = telling_of(scene)
    assert found
    assert not found.nothing
    assert min(found.follows.values()) > 0.9
    own = recording_of(scene)
    columns = np.column_stack([own.readings, noise(1, len(own.readings))])
    more = replace(own, readings=columns, sensors=(*own.sensors, "dead"))
    assert measured(more, split_of(scene)).nothing == ["dead"]


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
        done = run(*CALL, *command)
        assert done.returncode == 0, done.stderr
        assert "warning  dead: tells nothing" in done.stdout
        assert "ok       s1: without it force " in done.stdout
        assert done.stdout.count("tells nothing") == 1
    table = telling(scene)
    assert table
    assert [row[0] for row in table.rows] == ["none", "dead", *SENSORS, "all"]
    assert "dead: tells nothing, take it out" in table.note
