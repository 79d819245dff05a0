"""make predict: outputs are those of the twin, and what was never trained is told."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from golden.cli import CommandError
from golden.network_files.network_file import save_network
from golden.precision import SIGNAL
from golden.rig.csv_file import read_csv_file
from golden.rig.predict import check_place, predict, readings_of, write_prediction
from golden.rig.trained_on import TrainedOn, trained_on
from golden.scene import Scene, load_scene
from golden.scene.vectors import read_recorded
from golden.table import read_table, write_table
from golden.training.split import split_of, split_story
from tb.common.cases import random_mlp, write_scene

ROOT = Path(__file__).parents[1]


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    """A cascade whose networks were, as their provenance says, trained on its readings."""
    mlps = [random_mlp((3 + i, 4, 1), 0.5, i) for i in range(2)]
    path = write_scene(
        tmp_path, "rig", "exact", mlps, "cascade", "precise", "{}", rows=60, design="engine"
    )
    scene = load_scene(str(path))
    for member, mlp in zip(scene.members, mlps, strict=True):
        shape = ":".join(str(n) for n in mlp.shape)
        save_network(member.weights_path, mlp, {**split_story(scene), "network": shape})
    return load_scene(str(path))


def new_csv(folder: Path, text: str) -> Path:
    path = folder / "new.csv"
    path.write_text(text, encoding="utf-8")
    return path


def done(scene: Scene, source: Path) -> list[dict[str, str]]:
    """The rows of the file that is written."""
    recording = read_csv_file(source)
    found = predict(scene, readings_of(scene, recording), trained_on(scene)[0])
    out = source.with_name("out.csv")
    write_prediction(scene, recording, found, out)
    with out.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_outputs_are_those_of_the_twin(scene: Scene) -> None:
    rows = done(scene, scene.data_path)
    wanted = SIGNAL.to_real(scene.twin().process(scene.vectors().codes))
    got = np.array([[float(row["y0_predicted"]), float(row["y1_predicted"])] for row in rows])
    # Four decimals tell two codes apart.
    assert np.array_equal(np.rint(got * 8192), wanted * 8192)
    assert "." in rows[0]["y0_predicted"]


def test_every_column_stays_as_it_stands(scene: Scene) -> None:
    source = new_csv(scene.path.parent, 'when,x2,x0,"a, b",x1\n08:15,0.10,-0,"x ""y""",1e-1\n')
    rows = done(scene, source)
    assert list(rows[0])[:5] == ["when", "x2", "x0", "a, b", "x1"]
    assert list(rows[0].values())[:5] == ["08:15", "0.10", "-0", 'x "y"', "1e-1"]
    sensors = np.array([[0, 0.1, 0.1]])
    results = scene.outputs_in_units(scene.twin().process(scene.codes_of(sensors)))
    assert float(rows[0]["y1_predicted"]) == pytest.approx(results[0, 1], abs=1e-4)
    assert list(rows[0])[5:] == ["y0_predicted", "y1_predicted", "distance", "outside", "reason"]


def test_outputs_are_in_the_units_of_the_scene(scene: Scene) -> None:
    """The same network file, an output that counts in another unit."""
    text = scene.path.read_text()
    scaled = scene.path.with_name("scaled.toml")
    scale = "scale = { y1 = { offset = 100.0, factor = 2.0 } }\noutputs ="
    scaled.write_text(text.replace("outputs =", scale))
    table = read_table(scene.data_path, ["x0", "x1", "x2", "y0", "y1"])
    table[:, 4] = 100 + table[:, 4]
    write_table(scene.data_path, ["x0", "x1", "x2", "y0", "y1"], table, 4)
    other = load_scene(str(scaled))
    rows = done(other, other.data_path)
    results = other.twin().process(other.vectors().codes)[:, 1]
    got = np.array([float(row["y1_predicted"]) for row in rows])
    assert np.array_equal(np.rint((got - 100) / 2 * 8192), results)


def grid(rows: int) -> np.ndarray:
    """Readings on a line from corner to corner, in steps of 0.1."""
    return np.linspace(0, 0.1 * (rows - 1), rows)[:, np.newaxis] * np.array([1.0, 100.0])


def test_what_was_never_trained_is_told() -> None:
    known = TrainedOn(("a", "b"), grid(11))
    new = np.array([[0.5, 50.0], [1.01, 100.0], [0.5, -1.0], [0.2, 80.0], [0.55, 55.0]])
    distances = known.distances(new)
    assert known.reasons(new, distances) == [
        "",
        "a above 1",
        "b below 0; far from every row that trained",
        "far from every row that trained",
        "",
    ]
    assert distances[0] == 0
    assert distances[4] == pytest.approx(0.5)


def test_the_units_of_sensors_do_not_matter() -> None:
    rng = np.random.default_rng(1)
    trained, new = rng.normal(0, 1, (40, 3)), rng.normal(0, 1, (20, 3))
    change = np.array([1.0, 4095.0, 1e-3])
    plain = TrainedOn("abc", trained).distances(new)
    assert np.allclose(TrainedOn("abc", trained * change + 7).distances(new * change + 7), plain)


def test_rows_that_trained_are_inside() -> None:
    for readings in (grid(11), np.tile(grid(5), (2, 1)), np.c_[grid(6)[:, 0], np.ones(6)]):
        known = TrainedOn(("a", "b"), readings)
        assert set(known.reasons(readings, known.distances(readings))) == {""}
    twice = TrainedOn(("a", "b"), np.tile(grid(5), (2, 1)))
    assert twice.distances(grid(5)[:1] + 0.01)[0] == np.inf


def test_it_is_compared_with_the_rows_that_trained(scene: Scene) -> None:
    known, which = trained_on(scene)
    recorded = read_recorded(scene).inputs
    rows = split_of(scene).training
    assert 0 < len(rows) < len(recorded)
    assert np.array_equal(known.readings, recorded[rows])
    assert which == "the 30 rows that trained"


def test_of_networks_from_elsewhere_all_rows_count(scene: Scene) -> None:
    for story in scene.path.parent.glob("*.provenance.toml"):
        story.unlink()
    known, which = trained_on(scene)
    assert np.array_equal(known.readings, read_recorded(scene).inputs)
    assert which == "all 60 recorded rows; which of them trained is unknown"


def test_of_networks_that_were_trained_on_all_rows_count(scene: Scene) -> None:
    for story in scene.path.parent.glob("*.provenance.toml"):
        story.write_text(story.read_text() + "refit = true\n")
    known, which = trained_on(scene)
    assert np.array_equal(known.readings, read_recorded(scene).inputs)
    assert which == "all 60 recorded rows; all of them trained"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x0,x1\n1,2\n", "no column 'x2', which is a sensor"),
        ("x0;x1;x2\n1;2;3\n", "a semicolon between the cells"),
        ("x0,x1,x2\n1,,3\n", "new.csv:2: column 'x1': got an empty cell"),
        ('x0,x1,x2\n"0,5",0.1,nan\n', "expected '0.5' with a decimal point"),
        ('x0,x1,x2\n"0,5",0.1,nan\n', "column 'x2': got 'nan'"),
        ("x0,x1,x2,outside\n0,0,0,0\n", "column 'outside' is there already"),
        ("x0,x1,x2,y1_predicted\n0,0,0,0\n", "column 'y1_predicted' is there already"),
    ],
)
def test_faults_of_new_readings(scene: Scene, text: str, message: str) -> None:
    source = new_csv(scene.path.parent, text)
    with pytest.raises(ValueError, match=r"new\.csv") as refused:
        done(scene, source)
    assert message in str(refused.value)
    assert not source.with_name("out.csv").exists()


@pytest.mark.parametrize("name", ["new.csv", "rig.toml", "rig.csv", "rig-1.npz", "."])
def test_nothing_that_is_read_is_written_over(scene: Scene, name: str) -> None:
    source = new_csv(scene.path.parent, "x0,x1,x2\n0,0,0\n")
    with pytest.raises(
        (CommandError, ValueError),
        match=r"is read, expected|got a folder, expected",
    ):
        check_place(scene, source, scene.path.parent / name)
    check_place(scene, source, scene.path.parent / "out.csv")


def run(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "golden.rig.predict", *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_command(scene: Scene) -> None:
    source = new_csv(scene.path.parent, "x0,x1,x2\n0,0,0\n0.999,0.1,-5\n")
    out = scene.path.parent / "out.csv"
    out.write_text("an older one")
    result = run(str(scene.path), str(source), str(out))
    assert result.returncode == 0, result.stderr
    assert "1 of 2 rows are outside the 30 rows that trained" in result.stdout
    assert out.read_text().splitlines()[2].endswith("far from every row that trained")
    for words in ((str(scene.path), "", "a.csv"), (str(scene.path), str(source), "")):
        refused = run(*words)
        assert refused.returncode == 2
        assert "=: missing, expected a .csv file" in refused.stderr
