"""Tests make scene: what it says of readings, and the scene that it writes."""

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft7Validator
from onnx import TensorProto, helper, numpy_helper

from golden.input_error import InputError
from golden.trained.dense import Quantiser, layers_of, network_of
from golden.trained.function import Function
from tactus.core.finding import FAULT
from tactus.core.table import read_csv_file, read_table
from tactus.network_files.network_file import write_network
from tactus.network_files.parsed import ParsedNetwork
from tactus.rig import readings
from tactus.rig.draft import draft, weights
from tactus.rig.network_of_others import Brought, brought
from tactus.rig.survey import Survey, survey
from tactus.rig.write_scene import names_of, write_scene
from tactus.scene import Scene, load_scene
from tactus.scene.codes import saturating as scene_saturating
from tactus.scene.reading import EDITOR_SCHEMA
from tactus.train.descent.scaling import scaled
from tb.common.cases import random_network

ROOT = Path(__file__).parents[1]
BELL = Function("bell", "exp(-x * x)")
node = helper.make_node
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
    "bell.npz": random_network((3, 4, 2), ("table:bell",), 1.0, 1, functions=(BELL,)),
}


@pytest.mark.parametrize("times", [1, 20])
@pytest.mark.parametrize("name", ["tanh.npz", "relu.onnx"])
def test_a_scene_for_a_network_from_elsewhere(tmp_path: Path, name: str, times: int) -> None:
    """It computes what the file does, whatever the range of the readings."""
    network, file = NETWORKS[name], tmp_path / "nets" / name
    file.parent.mkdir()
    layers = list(layers_of(network))
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


def test_functions_of_the_file_are_not_named(tmp_path: Path) -> None:
    made = [node("MatMul", ["x", "w1"], ["a"]), node("Gelu", ["a"], ["b"])]
    made.append(node("MatMul", ["b", "w2"], ["y"]))
    weights_ = {"w1": np.eye(3, 4), "w2": np.full((4, 2), 0.1)}
    ends = [[helper.make_tensor_value_info(n, TensorProto.DOUBLE, [None, 3])] for n in "xy"]
    tensors = [numpy_helper.from_array(v, k) for k, v in weights_.items()]
    file = tmp_path / "gelu.onnx"
    graph = helper.make_graph(made, "test", *ends, tensors)
    file.write_bytes(helper.make_model(graph).SerializeToString())
    found = look(tmp_path)
    scene = write_scene(found, tmp_path / "mine.toml", network=brought(file, found))
    (network,) = scene.networks()
    assert layers_of(network)[0].activation == "table:gelu"
    assert "activations" not in (tmp_path / "mine.toml").read_text()


def test_the_range_of_a_quantised_network_is_a_power_of_two() -> None:
    held = ParsedNetwork({}, ("relu",), quantisers=(Quantiser(0.25, 0, 0, 15),))
    network = Brought(Path("net.onnx"), held)
    for values, factor in (([-3.0, 1.0], 4.0), ([0.0, 4.0], 8.0), ([-0.3, 0.2], 0.5)):
        assert network.range_of(np.array(values)) == (0.0, factor)
    offset, factor = replace(network, held=ParsedNetwork({})).range_of(np.array([100.0, 1000.0]))
    assert (offset, factor) == (550.0, 500.0)


@pytest.mark.parametrize(
    ("shape", "outputs", "message"),
    [
        ((2, 4, 2), "force,place", "got a network of 2 inputs, expected 3, one for each sensor of"),
        ((3, 4, 1), "force,place", "got a network of 1 outputs, expected 2, one for each output"),
        ((4, 4, 2), "force,place", "idle is left out: "),
    ],
)
def test_a_network_for_other_columns_is_refused(tmp_path: Path, shape, outputs, message) -> None:
    file = tmp_path / "net.npz"
    write_network(file, random_network(shape, ("tanh",), 1.0, 1))
    found = look(tmp_path, outputs, idle=np.zeros(60))
    with pytest.raises(InputError, match=f"net.npz: .*{message}"):
        brought(file, found)


def test_a_scene_that_cannot_name_the_network_is_not_written(tmp_path: Path) -> None:
    file = tmp_path / "bell.npz"
    write_network(file, NETWORKS["bell.npz"])
    found = look(tmp_path)
    with pytest.raises(InputError, match=r"no function 'bell', expected it in \[network"):
        write_scene(found, tmp_path / "mine.toml", network=brought(file, found))
    assert not (tmp_path / "mine.toml").exists()


def look(folder: Path, outputs: str = "force,place", **changed: object) -> Survey:
    """The survey of the readings, with some columns changed or added."""
    path = folder / "rig.csv"
    path.write_text(text_of(TABLE | changed), encoding="utf-8")
    return survey(read_csv_file(path), names_of(outputs))


def texts(found: Survey) -> str:
    return "\n".join(map(str, found.findings))


def test_nothing_is_said_of_good_readings(tmp_path: Path) -> None:
    found = look(tmp_path)
    assert not found.findings
    assert not found.left_out
    assert list(found.sensors) == ["s1", "s2", "s3"]
    assert np.array_equal(found.outputs["place"], PLACE.round(4))
    assert found.lines()[0] == (
        f"  s1     sensor    {found.sensors['s1'].min():g} to {found.sensors['s1'].max():g}, "
        f"{len(set(found.sensors['s1']))} different values"
    )


def clipped() -> np.ndarray:
    return np.minimum(TABLE["s1"], np.sort(TABLE["s1"])[-8])


def halves() -> dict[str, object]:
    """Columns in which every second row is the mean of its neighbours."""
    changed = {}
    for name in ("s1", "s2", "s3"):
        values = TABLE[name].round(3)
        values[1:-1:2] = (values[:-2:2] + values[2::2]) / 2
        changed[name] = values
    return changed


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"s1": clipped()}, r"warning  s1: 8 readings are exactly [\d.]+, its largest"),
        ({"s2": -clipped()}, r"warning  s2: 8 readings are exactly -[\d.]+, its least"),
        ({"s3": TABLE["s3"] / 100}, r"warning  s3: moves over \d+ of the 16384 codes"),
        (halves(), r"29 of 60 rows are exact means of the rows beside them"),
        ({"s1": TABLE["s1"] * 3}, r"note     .*'s1' reaches 1\.\d+, .*scales every column"),
        ({"Kraft [N]": TABLE["s1"] ** 2}, r"note     .*'Kraft \[N\]': names with other signs"),
    ],
)
def test_what_is_seen_is_said(tmp_path: Path, changed: dict[str, object], said: str) -> None:
    found = look(tmp_path, **changed)
    assert len(found.findings) == 1
    assert not any(finding.verdict == FAULT for finding in found.findings)
    assert re.search(said, texts(found)), texts(found)


@pytest.mark.parametrize(
    ("column", "why"),
    [
        (["x"] * 60, "no numbers, line 2 holds 'x'"),
        ([""] * 60, "no numbers, line 2 holds ''"),
        (np.full(60, 0.5), "0.5 in every row"),
        (np.arange(60.0), "counts the rows"),
        (np.arange(60) / 100 + 7, "counts the rows"),
        (0.25 - 0.5 * TABLE["s2"].round(4), "repeats the sensor 's2', perhaps in another unit"),
        (PLACE.round(4) * 0.5, "repeats the output 'place', perhaps in another unit"),
    ],
)
def test_columns_that_are_no_sensors_are_left_out(tmp_path: Path, column, why: str) -> None:
    found = look(tmp_path, more=column)
    assert found.left_out == {"more": why}
    assert "more" not in found.sensors


@pytest.mark.parametrize(("sessions", "grouped", "split"), [(6, 1, 1), (2, 1, 1), (60, 0, 0)])
def test_sessions_that_have_names_are_held_out_whole(
    tmp_path: Path, sessions: int, grouped: bool, split: bool
) -> None:
    found = look(tmp_path, day=[f"day {row * sessions // 60}" for row in range(60)])
    text = draft(found, tmp_path / "mine.toml")
    assert ('group_by = "day"' in text) == grouped
    assert ('split = "groups"\nsplit_by = ["day"]' in text) == split


def test_a_column_without_a_name_is_left_out_and_holds_no_classes(tmp_path: Path) -> None:
    found = look(tmp_path, **{"": np.arange(60.0)})
    assert found.left_out == {"column 6": "has no name"}
    assert "classes" not in "".join(found.lines())


def with_cell(text: str) -> list[str]:
    cells = [f"{value:.4f}" for value in TABLE["s1"]]
    cells[4] = text
    return cells


@pytest.mark.parametrize(
    ("outputs", "changed", "fault"),
    [
        ("force,plac", {}, "no column 'plac'; did you mean 'place'?"),
        ("", {}, "OUTPUTS=: got none, expected each once some of the columns s1, s2, s3, force"),
        ("force,force", {}, "OUTPUTS=: got force,force, expected each once"),
        ("force,place", {"force": np.ones(60)}, "output 'force': got 1 in every row"),
        ("force,place", {"s1": with_cell("")}, "rig.csv:6: column 's1': got an empty cell"),
        ("force,place", {"s1": with_cell("nan")}, "rig.csv:6: column 's1': got 'nan'"),
        ("force,place", {"s1": with_cell("1e999")}, "rig.csv:6: column 's1': got '1e999'"),
        ("force,place", {"s1": with_cell('"0,5"')}, "got '0,5', expected '0.5' with a decimal"),
        ("force,place", {"place": with_cell("far")}, "rig.csv:6: column 'place': got 'far'"),
        ("force,place", {f"s{k}": ["x"] * 60 for k in (1, 2, 3)}, "no column is a sensor"),
    ],
)
def test_faults(tmp_path: Path, outputs: str, changed: dict[str, object], fault: str) -> None:
    found = look(tmp_path, outputs, **changed)
    assert fault in "\n".join(str(f) for f in found.findings if f.verdict == FAULT), texts(found)


def test_several_bad_cells_are_counted(tmp_path: Path) -> None:
    cells = with_cell("")
    cells[10] = "-"
    assert "; 2 cells of the column are none" in texts(look(tmp_path, s1=cells))


def test_too_few_rows(tmp_path: Path) -> None:
    few = {name: values[:7] for name, values in TABLE.items()}
    assert "fault    " in texts(look(tmp_path, **few))
    assert "got 7 rows, expected at least 8" in texts(look(tmp_path, **few))
    some = {name: values[:30] for name, values in TABLE.items()}
    assert "warning  " in texts(look(tmp_path, **some))
    assert "30 rows: 15 train, 7 choose" in texts(look(tmp_path, **some))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda t: text_of(TABLE, ";"),
            "a semicolon between the cells, expected a comma; tr ';' ','",
        ),
        (
            lambda t: text_of(TABLE, ";", ","),
            "a semicolon between the cells and decimal commas, expected a comma and decimal "
            "points; tr ';,' ',.'",
        ),
        (lambda t: text_of(TABLE, "\t"), "a tab between the cells, expected a comma; tr '\\t' ','"),
        (lambda t: text_of(TABLE, "|"), "a bar between the cells"),
        (lambda t: text_of(TABLE, "  "), "blanks between the cells"),
        (lambda t: "sep=;\n" + text_of(TABLE, ";"), "a semicolon between the cells"),
        (lambda t: text_of(TABLE, ",", ","), "rig.csv:2: got 10 cells, expected 5; is that a"),
        (lambda t: t.replace("place", "force", 1), "column 'force' stands twice in the header"),
        (lambda t: t.partition("\n")[2], "the first line holds numbers, expected the names"),
        (lambda t: t.splitlines()[0], "got 1 lines, expected a header and at least one row"),
        (lambda t: "", "got 0 lines"),
        (lambda t: t + "1,2\n", "rig.csv:62: got 2 cells, expected 5"),
        (lambda t: t.encode("utf-16"), "got UTF-16, expected UTF-8"),
        (lambda t: t.replace("s1", "Höhe").encode("latin-1"), "rig.csv:1: got byte 0xf6"),
    ],
)
def test_what_is_no_csv_is_refused(tmp_path: Path, change: Callable, message: str) -> None:
    path = tmp_path / "rig.csv"
    made = change(text_of(TABLE))
    path.write_bytes(made if isinstance(made, bytes) else made.encode())
    with pytest.raises(InputError, match=r"rig\.csv") as refused:
        read_csv_file(path)
    assert message in str(refused.value)


@pytest.mark.parametrize(("sign", "point"), [(";", "."), (";", ","), ("\t", "."), ("\t", ",")])
def test_the_command_that_it_names_mends_the_file(tmp_path: Path, sign: str, point: str) -> None:
    (tmp_path / "my rig.csv").write_text(text_of(TABLE, sign, point))
    with pytest.raises(InputError, match="converts it") as refused:
        read_csv_file(tmp_path / "my rig.csv")
    command = str(refused.value).rpartition("; ")[2].removesuffix(" converts it")
    subprocess.run(command, shell=True, cwd=tmp_path, check=True)
    assert (tmp_path / "comma.csv").read_text() == text_of(TABLE)


@pytest.mark.parametrize("mark", ["\ufeff", "\n\n"])
def test_a_mark_and_empty_lines_do_no_harm(tmp_path: Path, mark: str) -> None:
    (tmp_path / "rig.csv").write_text(mark + text_of(TABLE) + "\n,,,,\n", encoding="utf-8")
    recording = read_csv_file(tmp_path / "rig.csv")
    assert recording.names == tuple(TABLE)
    assert len(recording.rows) == 60


def test_the_interpolated_rows_of_the_digit_are_seen() -> None:
    """Every second row of sensors 1 to 3 was interpolated. Sensor 4 was read in every row."""
    scene = load_scene("digit")
    assert len(readings.on_lines(scene.vectors().inputs)) == 62
    page = (ROOT / "docs" / "limits.md").read_text()
    assert "`62 of 143 rows are exact means of the rows beside them`" in page
    noisy = scene.vectors().inputs + np.random.default_rng(1).normal(0, 0.01, (143, 4)).round(4)
    assert len(readings.on_lines(noisy)) < 5


def test_readings_that_stay_are_no_lines() -> None:
    steps = np.repeat(np.random.default_rng(2).uniform(-1, 1, (6, 3)).round(4), 10, axis=0)
    assert not len(readings.on_lines(steps))
    assert len(readings.on_lines(np.linspace([0, 0, 0], [1, 2, -3], 11))) == 9


# --- the scene


def scene_of(folder: Path, outputs: str = "force,place", **changed: object) -> Scene:
    return write_scene(look(folder, outputs, **changed), folder / "my-rig.toml")


def test_the_scene_is_what_the_readings_ask_for(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, number=np.arange(60))
    assert scene.sensors == ("s1", "s2", "s3")
    assert scene.outputs == ("force", "place")
    assert scene.arrangement == "cascade"
    assert scene.group_by == "force"
    assert scene.full_scale == {"force": 0.4, "place": pytest.approx(np.ptp(PLACE), abs=1e-4)}
    assert [path.name for path in scene.weights_paths] == ["my-rig-force.npz", "my-rig-place.npz"]
    assert scene.data_path == tmp_path / "rig.csv"
    text = scene.path.read_text()
    assert "# Left out: number, counts the rows.\n" in text
    assert "no target is 0" in text


def test_measured_values_of_which_some_repeat_are_no_positions(tmp_path: Path) -> None:
    force = np.append(np.repeat(np.linspace(0.1, 0.9, 29), 2), [0.01, 0.99])
    assert scene_of(tmp_path, "force,place", force=force.round(2)).group_by == ""


def test_one_output_is_one_network(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, "place")
    assert scene.arrangement == "single"
    assert scene.group_by == ""
    assert scene.sensors == ("s1", "s2", "s3", "force")
    assert [path.name for path in scene.weights_paths] == ["my-rig.npz"]


def test_targets_of_zero_have_a_full_scale(tmp_path: Path) -> None:
    assert scene_of(tmp_path, place=PLACE - PLACE[0]).vectors().targets.shape == (60, 2)


def test_interpolated_rows_are_held_out_in_blocks(tmp_path: Path) -> None:
    assert scene_of(tmp_path).training.split == "random"
    (tmp_path / "own").mkdir()
    assert scene_of(tmp_path / "own", **halves()).training.split == "blocks"


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


def test_units_are_taken_from_the_names(tmp_path: Path) -> None:
    named = {"load [g]": FORCE, "x (mm)": PLACE, "s4 [m V]": TABLE["s1"] ** 2, "[g]": PLACE**2}
    scene = scene_of(tmp_path, "load [g],x (mm)", **named)
    assert scene.units == {"load [g]": "g", "x (mm)": "mm", "s4 [m V]": "m V"}
    (tmp_path / "plain").mkdir()
    assert "units" not in scene_of(tmp_path / "plain").path.read_text()


AWKWARD = ["Kraft, N", "a'b", "läge (mm)", "a\\b", "# no comment", "]", "a = 1", "日本"]


def test_awkward_names_stay_what_they_are(tmp_path: Path) -> None:
    outputs = {name: RNG.uniform(0.1, 0.9, 60) for name in AWKWARD}
    sensors = {f"s {name}": RNG.uniform(-0.9, 0.9, 60) for name in AWKWARD}
    words = ",".join(f'"{name}"' if "," in name else name for name in AWKWARD)
    scene = scene_of(tmp_path, words, **outputs, **sensors)
    assert scene.outputs == tuple(AWKWARD)
    assert set(sensors) < set(scene.sensors)
    assert set(scene.full_scale) == set(AWKWARD)
    assert len(set(scene.weights_paths)) == len(AWKWARD)
    assert all(path.name.isascii() for path in scene.weights_paths)


def test_names_of_networks_do_not_collide() -> None:
    path = Path("rig.toml")
    assert weights(["a b", "c"], path) == ["rig-a-b.npz", "rig-c.npz"]
    assert weights(["a b", "a-b"], path) == ["rig-1.npz", "rig-2.npz"]
    assert weights(["ä", "ö"], path) == ["rig-1.npz", "rig-2.npz"]


@pytest.mark.parametrize(
    "there", ["my-rig.toml", "my-rig-force.npz", "my-rig-place.provenance.toml"]
)
def test_nothing_is_overwritten(tmp_path: Path, there: str) -> None:
    (tmp_path / there).write_text("mine")
    with pytest.raises(InputError, match=f"{there}: is there already"):
        scene_of(tmp_path)
    assert (tmp_path / there).read_text() == "mine"
    assert {path.name for path in tmp_path.iterdir()} == {"rig.csv", there}


def test_the_csv_may_stand_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "scenes").mkdir()
    scene = write_scene(look(tmp_path / "data"), tmp_path / "scenes" / "my.toml")
    assert tomllib.loads(scene.path.read_text())["data"]["file"] == "../data/rig.csv"
    assert len(scene.vectors().codes) == 60


# --- the command


def run(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tactus.cli.scene", *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_command_says_what_it_saw_and_writes(tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    path.write_text(text_of(TABLE | {"who": ["me"] * 60}))
    done = run(str(path), "force, place")
    assert done.returncode == 0, done.stderr
    assert f"{path}: 60 rows, 6 columns" in done.stdout
    assert "  who    left out  no numbers, line 2 holds 'me'" in done.stdout
    assert f"wrote {tmp_path / 'rig.toml'}: 2 networks in cascade, 3 sensors" in done.stdout
    assert read_table(path, ["s1"]).shape == (60, 1)


def test_all_faults_are_told_at_once(tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    path.write_text(text_of(TABLE | {"s1": with_cell(""), "s2": with_cell("x")}))
    done = run(str(path), "force,place,width")
    assert done.returncode == 2
    assert [line.partition(": ")[0] for line in done.stderr.splitlines()] == ["error"] * 3
    assert not path.with_suffix(".toml").exists()


def test_an_editor_finds_the_schema_of_what_is_written(tmp_path: Path) -> None:
    """The first line names the schema relative to the scene, which has no marked faults."""
    path = tmp_path / "rig.toml"
    write_scene(look(tmp_path), path)
    text = path.read_text()
    named = text.splitlines()[0].removeprefix("#:schema ")
    assert (tmp_path / named).samefile(EDITOR_SCHEMA)
    judge = Draft7Validator(json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8")))
    assert judge.is_valid(tomllib.loads(text))
