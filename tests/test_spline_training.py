"""``make train`` for networks of learned functions."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.numbers.precision import SIGNAL
from tactus.cli import train as command
from tactus.errors.decisions import decisions_of
from tactus.network_files.network_file import provenance_path
from tactus.scene import Scene, load_scene
from tactus.train import spline_training
from tactus.train.descent.objective import Rows
from tactus.train.descent.search import bit_true_error
from tactus.train.spline_layers import function_network
from tactus.train.spline_training import (
    SplineStages,
    measure,
    train,
)
from tactus.train.splines import training as splines
from tactus.train.splines.edges import CURVED, FLAT, STRAIGHT
from tactus.train.splines.training import Learned, SplineSettings

ROWS = 60


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    """Two sums of curves of three readings, in a cascade on an engine."""
    rng = np.random.default_rng(1)
    x = rng.uniform(0.1, 0.8, (ROWS, 3))
    first = 0.3 * x[:, 0] ** 2 + 0.4 * np.sqrt(x[:, 1]) + 0.1 * x[:, 2]
    second = 0.5 * first**2 + 0.3 * x[:, 2]
    lines = ["a,b,c,u,v"]
    lines += [",".join(f"{value:.5f}" for value in row) for row in np.c_[x, first, second]]
    (tmp_path / "curves.csv").write_text("\n".join(lines) + "\n")
    path = tmp_path / "curves.toml"
    path.write_text(
        """
[data]
file = "curves.csv"
sensors = ["a", "b", "c"]
outputs = ["u", "v"]

[network]
arrangement = "cascade"
weights = ["u.npz", "v.npz"]

[hardware]
design = "engine"
segment_width = 11
precision = "exact"

[training]
functions = "spline"
hidden = [2, 2]
intervals = [2]
restarts = 1
steps = 20
refit = true
"""
    )
    return load_scene(str(path))


def test_it_trains_and_writes_what_an_engine_adds_up(scene: Scene, tmp_path: Path) -> None:
    command.train_scene(scene, tmp_path / "build", 1)
    scene = load_scene(str(scene.path))
    twin, vectors = scene.twin(), scene.vectors()
    found = SIGNAL.to_real(twin.process(vectors.codes))
    errors = 100 * np.abs((found - vectors.targets) / vectors.scale)
    # A straight line leaves errors of 2 % and more.
    assert errors.mean() < 1
    assert [len(one.layers) for one in twin.integers] == [2, 2]
    stories = [tomllib.loads(provenance_path(path).read_text()) for path in scene.weights_paths]
    assert sum(story["curved_edges"] for story in stories) == len(twin.graph.functions) > 0
    for number, story in enumerate(stories):
        assert story["functions"] == "spline"
        assert story["candidates"] == 3
        assert story["every_rms_percent"] < 1
        stages = SplineStages(scene)
        for one in stories[: number + 1]:
            stages.add(2, one["best_restart"])
        task = stages.task(stages.written, number)
        error = bit_true_error(task, stages.written[number], task.recorded)
        assert story["every_rms_percent"] == pytest.approx(error, abs=2e-4)


@pytest.mark.all_only
def test_an_interrupted_search_goes_on(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first network is whole; of the second there is a candidate, and a part of another."""
    command.train_scene(scene, tmp_path / "build", 1)
    networks = [path.read_bytes() for path in scene.weights_paths]
    first, second = sorted((tmp_path / "build").rglob("*.jsonl"))
    whole, lines = first.read_text(), second.read_text().splitlines(keepends=True)
    second.write_text(lines[0] + lines[1][:10])
    computed = []
    original = spline_training.measure
    monkeypatch.setattr(
        spline_training, "measure", lambda *a: computed.append(a[0].number) or original(*a)
    )
    command.train_scene(scene, tmp_path / "build", 1)
    assert computed == [1] * (len(lines) - 1)
    assert [path.read_bytes() for path in scene.weights_paths] == networks
    assert (first.read_text(), second.read_text()) == (whole, "".join(lines))


@pytest.mark.parametrize(("key", "value"), [("weight_decay", 1.0), ("steps", 2)])
def test_a_descent_is_that_of_the_scene(scene: Scene, key: str, value: float) -> None:
    task = SplineStages(scene).task([], 0)
    other = replace(scene, training=replace(scene.training, **{key: value}))
    found = [train(one, 2, 0).network.packed() for one in (task, replace(task, scene=other))]
    assert not np.array_equal(*found)


@pytest.mark.parametrize("intervals", [0, 2])
def test_what_hardware_gets_is_what_was_trained(intervals: int) -> None:
    """Within the range of training, the layers are the trained functions; beyond, they are held."""
    rng = np.random.default_rng(2)
    inputs = rng.uniform(-0.4, 0.6, (200, 3))
    target = (inputs[:, :1] ** 2 + 0.5 * inputs[:, 1:2]) * (0.4 + inputs[:, 2:])
    rows = Rows(inputs, target, np.ones_like(target))
    learned = splines.trained(SplineSettings(2, intervals, 4, 0.01), rng, rows, rows)
    learned = splines.pruned(learned, rows, rows, _rms)
    network = function_network(learned, inputs, 0).layers()
    assert np.abs(network.process(inputs) - learned.process(inputs)).max() < 1e-9
    far = network.process(rng.uniform(-1, 1, (500, 3)))
    assert np.abs(far).max() < 3


def test_sums_with_straight_functions_behind_them_become_one() -> None:
    rng = np.random.default_rng(4)
    inputs = rng.uniform(-0.4, 0.6, (200, 3))
    target = np.sin(3 * inputs[:, :1]) + inputs[:, 1:2] ** 2
    rows = Rows(inputs, target, np.ones_like(target))
    learned = splines.trained(SplineSettings(4, 2, 4, 0.01), rng, rows, rows)
    edges = learned.edges
    edges = replace(edges, second=np.array([[STRAIGHT, CURVED, STRAIGHT, STRAIGHT]]))
    edges = replace(edges, first=np.where(np.eye(4, 3) > 0, FLAT, edges.first))
    learned = learned.descended(edges, rows)
    found = splines.merged(learned)
    assert found.network.shape == (3, 2, 1)
    assert found.edges.second.tolist() == [[STRAIGHT, CURVED]]
    assert found.edges.first.tolist() == [[CURVED] * 3, [CURVED, FLAT, CURVED]]
    assert np.abs(found.process(inputs) - learned.process(inputs)).max() < 1e-9
    assert splines.merged(found) is found
    # Trained further, it stays what it is: the function of the sum is straight.
    assert np.abs(splines.refitted(found, rows).process(inputs) - target).max() < 0.2


def _rms(learned: Learned, rows: Rows) -> float:
    return float(np.sqrt(((learned.process(rows.inputs) - rows.targets) ** 2).mean()))


RINGS = """
[data]
file = "rings.csv"
sensors = ["a", "b"]
classes = "ring"

[network]
arrangement = "single"
weights = "rings.npz"

[hardware]
{hardware}
precision = "exact"
activation = "precise"

[training]
functions = "spline"
hidden = [1, 2]
intervals = [2]
restarts = 1
steps = 60
weight_decay = 0.01
refit = true
"""
TABLES = 'design = "table_graph"\nargmax = true\nsample_bits = 8\nhidden_bits = 8'


def rings(folder: Path, hardware: str) -> Scene:
    """Points in a disc and in two rings around it, which one sum of parabolas tells apart."""
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.7, 0.7, (180, 2))
    radius = np.sqrt((points**2).sum(axis=1))
    labels = np.array(["disc", "inner", "outer"])[np.digitize(radius, (0.35, 0.55))]
    lines = [f"{a:.4f},{b:.4f},{label}" for (a, b), label in zip(points, labels, strict=True)]
    (folder / "rings.csv").write_text("\n".join(["a,b,ring", *lines]) + "\n")
    path = folder / "rings.toml"
    path.write_text(RINGS.format(hardware=hardware))
    return load_scene(str(path))


@pytest.mark.all_only
@pytest.mark.parametrize("hardware", [TABLES, 'design = "engine"\nsegment_width = 11'])
def test_it_learns_classes(tmp_path: Path, hardware: str) -> None:
    """The decisions of the hardware are those of the file, and hardly any is wrong."""
    scene = rings(tmp_path, hardware)
    command.train_scene(scene, tmp_path / "build", 1)
    scene = load_scene(str(scene.path))
    story = tomllib.loads(provenance_path(scene.weights_paths[0]).read_text())
    decisions = decisions_of(scene)
    wrong = 100 * (decisions.bit_true != decisions.actual).mean()
    assert story["every_wrong_percent"] == pytest.approx(wrong, abs=1e-4)
    assert (story["functions"], story["candidates"]) == ("spline", 6)
    # Whoever always said "outer" would be wrong in every second row.
    assert story["every_wrong_percent"] < 5
    assert story["test_wrong_percent"] < 10
    assert decisions.differ <= 2
    # The file holds logits, and the functions fill the words of an output, of which at least a
    # quarter is used.
    (network,) = scene.networks()
    codes = scene.vectors().codes
    assert 0.4 < np.abs(network.process(SIGNAL.to_real(codes))).max() < 1
    assert story["curved_edges"] > 0


def test_what_hardware_cannot_compute_is_a_refused_candidate(tmp_path: Path) -> None:
    scene = rings(tmp_path, TABLES)
    options = {**scene.design_options, "hidden_bits": 99}
    found = measure(SplineStages(replace(scene, design_options=options)).task([], 0), 1, 0)
    assert found.validation == float("inf")
    assert "hidden_bits: got 99" in found.refused
