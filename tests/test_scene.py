"""Tests what is read of a scene, its schema for editors, raw units, and past samples."""

import csv
import json
import re
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft7Validator
from refused import call

from golden.common.block import walk
from golden.input_error import InputError, MissingFileError
from golden.instruments.readout import Readout
from golden.networks.axis_network import AxisNetwork
from golden.networks.network import CHUNK, Network
from golden.networks.windowed import Windowed
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL
from golden.sensing.frame_window import FrameWindow
from golden.trained.window import Window
from tactus.boards.board import BOARD
from tactus.boards.board import FOLDER as BOARDS
from tactus.cli import train as command
from tactus.cli.train import train_scene
from tactus.core.finding import faults as found_faults
from tactus.core.schema import OWN, Rule, faults, has_default, standard
from tactus.core.table import read_table, write_table
from tactus.errors import held_out_rows, provenances, scene_errors, unit_errors
from tactus.network_files.network_file import (
    load_network,
    provenance_path,
    read_provenance,
    save_network,
)
from tactus.physics.gauges import FOLDER as RIGS
from tactus.physics.gauges import RIG
from tactus.report.page.summary import built
from tactus.report.page.summary import in_units as in_units_of
from tactus.rig.check import everything
from tactus.scene import (
    DEFAULT_SCENES,
    Scene,
    class_names,
    comparison_names,
    load_scene,
    scene_names,
    scene_path,
)
from tactus.scene.codes import saturating
from tactus.scene.disturbance import Disturbance
from tactus.scene.keys import EDITOR_SCHEMA, SCENE
from tactus.scene.scale import Scale, on_readings, range_scale, readings, signals
from tactus.scene.vectors import read_recorded, warn_outside
from tactus.train import search
from tactus.train.split import scaled, split_of, split_rows
from tactus.train.task import task_for
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of, write_scene
from tb.common.case_library import CASE
from tb.common.cases import Case, random_mlp


def edited(scene: Scene, old: str, new: str) -> str:
    """Replace a text in the file of the scene, and return its path."""
    text = scene.path.read_text()
    assert old in text
    scene.path.write_text(text.replace(old, new))
    return str(scene.path)


def test_a_shipped_scene_needs_no_group_in_its_name() -> None:
    for name in (*scene_names(), *class_names(), *comparison_names()):
        assert load_scene(Path(name).name).path == load_scene(name).path


@pytest.mark.parametrize(("keys", "lanes"), [("", 2), ("lanes = 4", 4)])
def test_an_older_design_is_read_with_a_note(tmp_path, capsys, keys: str, lanes: int) -> None:
    networks = [random_mlp((2, 5, 1), 1.0, 1)]
    options = {"activation": "precise", "design": "lanes", "hardware": keys}
    path = write_scene(tmp_path, f"older{lanes}", "exact", networks, **options)
    assert load_scene(str(path)).twin().lanes == lanes
    said = f"note: {path}: [hardware] is read as design = 'engine', lanes = {lanes}\n"
    assert capsys.readouterr().err == said


@pytest.mark.parametrize(
    ("name", "text"),
    [("digit", "precise"), ("wine", "relu"), ("digit-sums", "functions in tables")],
)
def test_a_report_names_the_activation_of_the_networks(name: str, text: str) -> None:
    """The approximation of tanh is named where a network has tanh."""
    scene = load_scene(name)
    assert f", activation {text}, exact precision" in built(scene, scene.twin())[0]


def test_rows_are_chosen_by_the_values_of_columns(small_scene: Scene) -> None:
    lines = small_scene.data_path.read_text().splitlines()
    lines[3] = "0.25,0.5,0.1,0.5,0.5"
    lines[5] = "0.2500,0.5,0.2,0.6,0.6"
    lines[6] = "0.25,-0.5,0.3,1.5,0"
    small_scene.data_path.write_text("\n".join(lines))
    path = edited(small_scene, "[network]", "where = { x0 = 0.25, x1 = 0.5 }\n[network]")
    assert load_scene(path).vectors().inputs.tolist() == [[0.25, 0.5, 0.1], [0.25, 0.5, 0.2]]
    edited(small_scene, "x1 = 0.5", "x1 = -0.5")
    with pytest.raises(InputError, match=r"column 'y0': got a target of 1.5 in row 6, expected"):
        load_scene(path).vectors()


def test_a_window_without_a_past_rules_nothing_out(small_scene: Scene) -> None:
    text = "where = { x0 = 0.25 }\nwindow = { x1 = [0] }\n[network]"
    assert load_scene(edited(small_scene, "[network]", text)).window.plain


@pytest.mark.parametrize("name", scene_names())
def test_a_shipped_scene_has_no_faults(name: str, tmp_path: Path) -> None:
    scene = load_scene(name)
    twin = scene.twin()
    assert twin.outputs == len(scene.outputs)
    entities = [block.entity for block in walk(twin)]
    assert len(set(entities)) == len(entities)
    for path in scene.weights_paths:
        provenance = read_provenance(path)
        for key in ("optimiser", "seed", "restarts", "weight_decay", "steps", "patience"):
            assert provenance[key] == getattr(scene.training, key), key
    assert not list(saturating(scene))
    # Whether 5000 rows of each sensor tell something takes long to find.
    if not name.startswith("swing"):
        assert not found_faults(everything(scene, tmp_path))


@pytest.mark.parametrize(
    ("precision", "activation"), [("exact", "precise"), ("thesis", "gradient")]
)
def test_a_scene_that_names_no_activation_gets_that_of_its_precision(
    small_scene: Scene, precision: str, activation: str
) -> None:
    assert small_scene.activation == "gradient"
    edited(small_scene, 'activation = "gradient"\n', "")
    scene = load_scene(edited(small_scene, '"exact"', f'"{precision}"'))
    assert scene.activation == activation
    assert {a.block for a in scene.twin().activations} == {activation}


def test_the_default_scenes_have_the_same_sensors_and_outputs() -> None:
    first, *others = map(load_scene, DEFAULT_SCENES)
    for other in others:
        assert (other.sensors, other.outputs) == (first.sensors, first.outputs)
        assert (other.data_paths, other.reference) == (first.data_paths, first.reference)


SCENES = [scene_path(name) for name in (*scene_names(), *class_names(), *comparison_names())]
FILES = [
    *((SCENE, path) for path in SCENES),
    *((BOARD, path) for path in sorted(BOARDS.glob("*.toml"))),
    *((RIG, path) for path in sorted(RIGS.glob("*.toml"))),
]
# Values of each type, at the ends of spans and beyond, and choices that exist or do not.
VALUES: list[Any] = [
    *(True, False, -1, 0, 1, 7, 24, 25, 1024, 1025, 100_001, 1_000_001, -0.5, 0.5, 1.0001, 150.5),
    *(1e-5, 10_000.5, "", "a", "auto", "fewest", "scg", "engine", "exact", "mcp3208"),
    *([], [0], [1, 3], [0, 65_537], [1, 2, 3], ["a"], ["a", "a"], [""], [["a"]], [1.5], ["a", 1]),
    *({}, {"a": 1}, {"a": "b"}, {"a": "auto"}, {"a": [0]}, {"a": ["b"]}, {"a": 0}, {"a": {}}),
    *({"gain": 1}, {"gain": 101}, {"gian": 1}, {"a": {"factor": 2}}, {"a": {"factor": 0}}),
    *({"a": {"offset": 2}}, {"a": {"factor": 2, "offset": 1}}, {"position": 1}, {"width": 0}),
]


def sections(table: Rule) -> Iterator[tuple[str, Rule]]:
    """Every key within a table, with its place. A table comes after the keys in it."""
    for name, key in table["properties"].items():
        if "properties" in key:
            yield from ((f"{name}.{inner}", below) for inner, below in sections(key))
        yield name, key


def rules(rule: Rule) -> Iterator[Rule]:
    """A rule and all rules within it."""
    yield rule
    inner = [rule[word] for word in ("items", "additionalProperties") if word in rule]
    for below in (*inner, *rule.get("anyOf", ()), *rule.get("properties", {}).values()):
        yield from rules(below)


KEYS = [(name, key) for table in (SCENE, BOARD, RIG) for name, key in sections(table)]


@pytest.mark.parametrize(("table", "path"), FILES, ids=lambda part: getattr(part, "stem", ""))
def test_every_shipped_file_is_accepted(table: Rule, path: Path) -> None:
    schema = standard(table)
    Draft7Validator.check_schema(schema)
    raw = tomllib.loads(path.read_text(encoding="utf-8"))
    assert not [error.message for error in Draft7Validator(schema).iter_errors(raw)]


def test_schema_and_check_agree() -> None:
    """They agree on every value: the schema marks just the values that the check refuses."""
    for (name, key), value in product(KEYS, VALUES):
        judge = Draft7Validator(standard(key))
        found = list(faults(key, value, name))
        assert judge.is_valid(value) == (not found), (value, found)
        assert all(fault.startswith(name) for fault in found), found


@pytest.mark.parametrize("table", [SCENE, BOARD, RIG], ids=["scene", "board", "rig"])
def test_every_word_of_a_declaration_is_known(table: Rule) -> None:
    """A misspelt limit would be no limit, for the check and for an editor."""
    known = OWN | Draft7Validator.META_SCHEMA["properties"].keys()
    for rule in rules(table):
        assert rule.keys() <= known, rule


def test_a_default_is_what_may_stand_there() -> None:
    """Others mean that there is none: they are empty, or a 0 that may not stand there."""
    for name, key in KEYS:
        if "default" in key and not has_default(key):
            assert key["default"] in ("", [], {}, 0), name


def test_a_key_asks_of_others_what_may_stand_there() -> None:
    """Or nothing, which is written as an empty text."""
    keys = dict(sections(SCENE))
    for key in keys.values():
        for other, known in key.get("only", {}).items():
            assert other in keys
            for value in () if known == "any" else known:
                assert value == "" or not list(faults(keys[other], value, other)), other


def test_every_key_has_a_meaning_that_an_editor_can_show() -> None:
    schema = json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8"))
    for section, table in SCENE["properties"].items():
        for name in table["properties"]:
            shown = schema["properties"][section]["properties"][name]
            assert not re.search(r"`|\]\(", shown["description"])


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
    (table,) = in_units_of(scene)
    assert [row[:2] for row in table.rows] == [["y0", "g"], ["y1", "its unit"]]
    assert table.rows[1][2] == pytest.approx(0.7 * percent.mean)
    (table,) = in_units_of(load_scene("digit"))
    lengths, found = {"position": 127, "width": 50.8}, scene_errors(load_scene("digit"))["bit-true"]
    for (name, unit, mean, *_), n in zip(table.rows, (1, 2), strict=True):
        assert (unit, mean) == ("mm", pytest.approx(found[n].mean * lengths[name] / 100))


def test_make_vhdl_prints_what_the_ends_of_the_codes_are(tmp_path, capsys) -> None:
    scene = in_units(tmp_path)
    call("vhdl", scene.path, "verilog", "--build", tmp_path / "build")
    printed = capsys.readouterr().out.splitlines()
    assert "sensor x0: code -8192 is 0 V, 8191 is 4.99969 V, one code 0.000305176 V" in printed
    assert "output y1: code -8192 is -10, 8191 is 129.991, one code 0.00854492" in printed
    assert not any("x1" in line for line in printed)


def trained_anew(scene: Scene, build: Path) -> Scene:
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
    again = trained_anew(scene, tmp_path / "build")
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
    again = trained_anew(in_units(tmp_path, rows=40, keys=AUTO), tmp_path / "build")
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
    again = trained_anew(scene, tmp_path / "build")
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


WINDOW = Window(((0, 2, 3), (0,), (1, 5)))
ROWS = (60, 47)
COLUMNS = ("a", "b", "c", "y")
WINDOWED_SCENE = """
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
    path.write_text(WINDOWED_SCENE)
    return load_scene(str(path))


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
        past = load_scene(edited(past, 'split = "blocks"\nblock_rows = 8\n', new))
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
    other = load_scene(edited(trained, "a = [0, 2, 3]", "a = [0, 2, 4]"))
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
    text = WINDOWED_SCENE.replace("c = [1, 5]", f"c = [1, {longest}]").replace("= 8", "= 50")
    past.path.write_text(text)
    scene = load_scene(str(past.path))
    if longest == 46:
        assert len(scene.vectors().codes) == 60 + 47 - 2 * 46
        return
    message = r"two.csv: got 47 rows, expected more than the 47 that data.window of .* reaches back"
    with pytest.raises(InputError, match=message):
        scene.vectors()


CODES = Fix(14, 13)


def block(window: Window, slots=0, spacing=100) -> FrameWindow:
    return FrameWindow(CODES, window, slots, spacing)


@pytest.fixture(scope="module")
def windowed(tmp_path_factory: pytest.TempPathFactory) -> Windowed:
    return scene_of(CASE["past"], tmp_path_factory.mktemp("past"), "past").twin()


def random_frames(count: int, sensors: int) -> np.ndarray:
    return np.random.default_rng(1).integers(CODES.low, CODES.high + 1, (count, sensors))


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
