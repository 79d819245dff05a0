"""Tests raw units: what codes stand for, the scale "auto", and readings outside the codes."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refused import call

from golden.input_error import InputError, MissingFileError
from golden.numbers.precision import SIGNAL
from tactus.cli import train as command
from tactus.cli.demo import length_lines
from tactus.errors import scene_errors, unit_errors
from tactus.network_files.network_file import (
    load_network,
    provenance_path,
    read_provenance,
    save_network,
)
from tactus.scene import Scene, load_scene
from tactus.scene.scale import Scale, on_readings, range_scale, readings, signals
from tactus.scene.vectors import warn_outside
from tactus.train import search
from tactus.train.split import scaled, split_rows
from tactus.train.task import task_for
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

# The scales of x0, x1, x2, y0, y1. An output with a relative error keeps its 0.
SCALES = [Scale(2.5, 2.5), Scale(), Scale(-300.0, 40.0), Scale(0.0, 25.0), Scale(60.0, 70.0)]
TEXT = """scale = { x0 = { offset = 2.5, factor = 2.5 }, x2 = { offset = -300, factor = 40.0 }, \
y0 = { factor = 25 }, y1 = { offset = 60, factor = 70 } }
units = { x0 = "V", y0 = "g" }
full_scale = { y1 = 70 }
"""


def in_units(folder: Path, rows: int = 12, keys: str = TEXT) -> Scene:
    """A 3:5:2 scene with recordings in raw units.

    Its network is that of ``signal_scene``, converted to take readings.
    """
    mlp = on_readings(random_mlp((3, 5, 2), 1.0, 1), SCALES[:3], SCALES[3:])
    path = write_scene(folder, "raw", "exact", [mlp], rows=rows)
    csv = path.with_suffix(".csv")
    lines = csv.read_text().splitlines()
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    raw = readings(values, SCALES)
    csv.write_text("\n".join([lines[0], *(",".join(f"{v:.5f}" for v in row) for row in raw)]))
    path.write_text(path.read_text().replace('group_by = "y0"\n', keys))
    return load_scene(str(path))


def signal_scene(folder: Path) -> Scene:
    """The same recordings and the same network, without units."""
    path = write_scene(folder, "plain", "exact", [random_mlp((3, 5, 2), 1.0, 1)])
    path.write_text(path.read_text().replace('group_by = "y0"\n', "full_scale = { y1 = 1 }\n"))
    return load_scene(str(path))


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.lists(st.floats(0, 1)))
def test_auto_leaves_a_quarter_of_the_range_at_either_end(
    start: float, width: float, between: list[float]
) -> None:
    scale = range_scale(start + width * np.array([*between, 0, 1]))
    found = signals(np.array([[start], [start + width]]), [scale]).ravel()
    # Factor and offset in three digits of the factor: each moves an end by half a hundredth.
    assert found == pytest.approx([-2 / 3, 2 / 3], abs=0.0101)
    assert float(f"{scale.factor:.2e}") == scale.factor


def test_a_scene_in_units_is_the_scene_without(tmp_path: Path) -> None:
    raw, plain = in_units(tmp_path), signal_scene(tmp_path)
    assert np.array_equal(raw.vectors().codes, plain.vectors().codes)
    assert np.allclose(raw.vectors().targets, plain.vectors().targets, atol=1e-6)
    assert raw.twin() == plain.twin()
    for kind, errors in scene_errors(plain).items():
        for one, other in zip(errors, scene_errors(raw)[kind], strict=True):
            assert one.mean == pytest.approx(other.mean, rel=1e-3), kind


def test_outputs_and_errors_in_units(tmp_path: Path) -> None:
    scene = in_units(tmp_path)
    codes = np.array([[SIGNAL.low, 0], [4096, SIGNAL.low]])
    assert scene.outputs_in_units(codes).tolist() == [[-25, 60], [12.5, -10]]
    assert scene.codes_of(np.array([[0.0, 0.5, -280.0]])).tolist() == [[SIGNAL.low, 4096, 4096]]
    # The errors are relative to a full scale of 70, so 1 % is 0.7 in the unit.
    percent = scene_errors(scene)["bit-true"][1]
    assert unit_errors(scene)["y1"].mean == pytest.approx(0.7 * percent.mean)
    assert [line.split("  ")[0] for line in length_lines(scene)] == ["y0 in g", "y1 in its unit"]


def test_make_vhdl_prints_what_the_ends_of_the_codes_are(tmp_path, capsys) -> None:
    scene = in_units(tmp_path)
    call("vhdl", scene.path, "verilog", "--build", tmp_path / "build")
    printed = capsys.readouterr().out.splitlines()
    assert "sensor x0: code -8192 is 0 V, 8191 is 4.99969 V, one code 0.000305176 V" in printed
    assert "output y1: code -8192 is -10, 8191 is 129.991, one code 0.00854492" in printed
    assert not any("x1" in line for line in printed)


def trained(scene: Scene, build: Path) -> Scene:
    command.train_scene(scene, build, 1)
    return load_scene(str(scene.path))


AUTO = 'scale = "auto"\nfull_scale = { y0 = 25, y1 = 70 }\n'


def test_auto_is_that_of_the_training_rows_and_stands_in_the_provenance(tmp_path: Path) -> None:
    scene = in_units(tmp_path, rows=40, keys=AUTO)
    split = split_rows(40, scene.training.seed)
    lines = scene.data_path.read_text().splitlines()
    row = int(split.test[0])
    cells = lines[row + 1].split(",")
    # These values are far beyond those of the training rows, in a sensor and in an output.
    lines[row + 1] = ",".join([*cells[:2], "900", "80", cells[4]])
    scene.data_path.write_text("\n".join(lines))
    again = trained(scene, tmp_path / "build")
    told = read_provenance(again.weights_paths[0])["scale"]
    assert list(told) == ["x0", "x1", "x2", "y0", "y1"]
    # An export depends on these files.
    assert provenance_path(again.weights_paths[0]) in again.files
    assert {n: Scale(**s) for n, s in told.items()} == again.known_scales
    x2, y0 = again.scales(["x2", "y0"])
    assert x2.offset + x2.factor < -220
    assert y0.offset + y0.factor > 80
    vectors = again.vectors()
    assert vectors.codes[row, 2] == SIGNAL.high
    assert "'x2': got 1 of 40 readings outside" in vectors.outside[0]
    assert f"the furthest 900 in row {row + 1}" in vectors.outside[0]


def test_what_is_trained_in_units_errs_as_its_provenance_says(tmp_path: Path) -> None:
    again = trained(in_units(tmp_path, rows=40, keys=AUTO), tmp_path / "build")
    provenance = read_provenance(again.weights_paths[0])
    task = task_for(again, again.vectors(), [])
    frames = task.recorded.take(task.split.test)
    errors = 100 * np.abs(task.bit_true(again.mlps()[0], frames) - frames.targets) / frames.scale
    rms = np.sqrt((errors**2).mean())
    assert provenance["test_rms_percent"] == pytest.approx(rms, abs=1e-4)
    # The file maps readings to units, even without its scene.
    file = load_network(again.weights_paths[0], (3, 5, 2))
    raw = readings(again.vectors().inputs, again.scales(again.sensors))
    assert np.allclose(
        file.process(raw),
        again.in_units(again.mlps()[0].process(signals(raw, again.scales(again.sensors)))),
    )


@pytest.mark.all_only
@pytest.mark.parametrize("column", ["x0", "x2"])
def test_training_works_with_what_the_readings_cover(tmp_path, monkeypatch, column: str) -> None:
    """The range of the converter is a hundred times larger. A column without scale stays."""
    adc = f"scale = {{ {column} = {{ factor = 400 }}, y0 = 'auto', y1 = 'auto' }}\n"
    scene = in_units(tmp_path, rows=40, keys=adc + "full_scale = { y0 = 25, y1 = 70 }\n")
    lines = [line.split(",") for line in scene.data_path.read_text().splitlines()]
    for line in lines[1:]:
        line[0] = line[2] = repr(-(float(line[1]) ** 2))
        line[["x0", "x1", "x2"].index(column)] = repr(3 * float(line[1]))
    scene.data_path.write_text("\n".join(",".join(line) for line in lines))
    scene = scaled(load_scene(str(scene.path)))
    task = task_for(scene, scene.vectors(), [])
    monkeypatch.setitem(search.OPTIMISERS, "levenberg-marquardt", lambda *_: None)
    mlp = search.train(task, (5,), 0)
    start = search.starting_weights((3, 5, 2), np.random.default_rng([1, 0, 5, 0]))
    inputs = task.training.inputs
    covered = inputs.copy()
    c = ["x0", "x1", "x2"].index(column)
    covered[:, c] = signals(inputs[:, [c]], [range_scale(inputs[:, c])]).ravel()
    assert np.ptp(inputs[:, c]) < 0.02 < 1 < np.ptp(covered[:, c])
    # The output biases are shifted after the training.
    moved = mlp.process(inputs, scene.scheme.real) - start.process(covered, scene.scheme.real)
    assert np.ptp(moved, axis=0) == pytest.approx([0, 0], abs=1e-12)


def test_auto_without_its_provenance_says_what_to_do(tmp_path: Path) -> None:
    scene = in_units(tmp_path, rows=40, keys=AUTO)
    message = (
        r"raw.toml: data.scale.x0: got 'auto', but .*raw.provenance.toml has no scale for it: "
        r"raw.npz was not trained here .* make train .* give \{ offset = , factor = \}"
    )
    with pytest.raises(InputError, match=message):
        scene.vectors()
    again = trained(scene, tmp_path / "build")
    assert again.vectors().codes.shape == (40, 3)
    # Another network replaces the one that the provenance describes.
    provenance = provenance_path(again.weights_paths[0])
    told = provenance.read_text()
    save_network(again.weights_paths[0], random_mlp((3, 5, 2), 1.0, 2), {})
    provenance.write_text(told)
    with pytest.raises(InputError, match=message):
        load_scene(str(scene.path)).mlps()
    provenance.unlink()
    with pytest.raises(InputError, match=message):
        load_scene(str(scene.path)).vectors()
    again.weights_paths[0].unlink()
    with pytest.raises(MissingFileError, match=r"no such network; make train"):
        load_scene(str(scene.path)).vectors()


def with_readings(scene: Scene, column: int, values: list[str]) -> Scene:
    """The scene with other cells at the top of a column."""
    lines = [line.split(",") for line in scene.data_path.read_text().splitlines()]
    for line, value in zip(lines[1:], values, strict=False):
        line[column] = value
    scene.data_path.write_text("\n".join(",".join(line) for line in lines))
    return load_scene(str(scene.path))


@pytest.mark.parametrize("run", ["train", "vhdl"])
def test_a_reading_outside_the_codes_is_warned_of(
    small_scene: Scene, tmp_path: Path, run: str
) -> None:
    scene = with_readings(small_scene, 1, ["-3.5"])
    message = (
        r"small.csv: column 'x1': got 1 of 12 readings outside -1 to 1, the furthest -3.5 in row 1"
    )
    with pytest.warns(UserWarning, match=message):
        warn_outside(scene)
    words = {"train": ["--workers", "1"], "vhdl": ["verilog"]}[run]
    with pytest.warns(UserWarning, match=message):
        call(run, scene.path, *words, "--build", tmp_path / "build")


def test_a_sensor_far_outside_the_codes_is_refused(small_scene: Scene) -> None:
    scene = with_readings(small_scene, 2, ["0.5", "120", "-70"])
    message = (
        r"small.csv: column 'x2': got 2 of 12 readings outside -1 to 1, the furthest 120 in row 2, "
        r"expected at most a tenth; give x2 a data.scale in .*small.toml"
    )
    with pytest.raises(InputError, match=message):
        scene.vectors()
    text = scene.path.read_text()
    wide = text.replace("[network]", "scale = { x2 = { factor = 128 } }\n[network]")
    scene.path.write_text(wide)
    assert load_scene(str(scene.path)).vectors().outside == ()
    scene.path.write_text(wide.replace("128", "100"))
    assert (
        "outside -100 to 100, the furthest 120" in load_scene(str(scene.path)).vectors().outside[0]
    )
