"""Tests networks of learned functions: their splines, derivatives, training and pruning."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import BSpline
from test_training import differences

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.spline_basis import Basis
from tactus.cli import train as command
from tactus.errors import decisions_of
from tactus.network_files.network_file import read_provenance
from tactus.scene import Scene, load_scene
from tactus.train.objective import Rows, normal_equations
from tactus.train.splines import search as splines
from tactus.train.splines.network import CURVED, FLAT, STRAIGHT, Edges, SplineNetwork, starting
from tactus.train.splines.objective import SplineObjective
from tactus.train.splines.search import (
    SplineSettings,
    Stages,
    function_network,
    measure,
    pruned,
    train,
    trained,
)
from tactus.train.task import bit_true_error

BASIS = Basis(-0.5, 1.5, 4)


def network(nodes: int = 2, outputs: int = 2, seed: int = 1) -> SplineNetwork:
    bases = (BASIS, Basis(-1.0, 1.0, 4), Basis(0.0, 1.0, 4))
    return starting(bases, 5, nodes, outputs, np.random.default_rng(seed))


def rows(count: int = 40, outputs: int = 2, seed: int = 2) -> Rows:
    rng = np.random.default_rng(seed)
    inputs = rng.uniform(-1, 1.5, (count, 3))
    return Rows(inputs, rng.normal(size=(count, outputs)), rng.uniform(0.5, 2, (count, outputs)))


def curve(count: int, seed: int, noise: float = 0.0) -> Rows:
    """Rows of a law of two of three inputs; the third tells nothing."""
    rng = np.random.default_rng(seed)
    inputs = rng.uniform(-1, 1, (count, 3))
    targets = np.exp(0.8 * inputs[:, :1] ** 2 + 0.5 * inputs[:, 1:2]) - 1
    return Rows(inputs, targets + noise * rng.normal(size=targets.shape), np.ones((count, 1)))


def rms(model, given: Rows) -> float:
    return float(np.sqrt(((model.process(given.inputs) - given.targets) ** 2).mean()))


def test_the_splines_are_those_of_scipy() -> None:
    knots = BASIS.low + BASIS.width * np.arange(-3, BASIS.intervals + 4)
    x = np.linspace(BASIS.low, BASIS.high, 50)[:-1]
    values, slopes = BASIS.at(x)
    expected = BSpline(knots, np.eye(BASIS.count), 3)
    np.testing.assert_allclose(values, expected(x), atol=1e-12)
    np.testing.assert_allclose(slopes, expected.derivative()(x), atol=1e-12)
    np.testing.assert_allclose(BASIS.bends(x), expected.derivative(2)(x), atol=1e-11)


def aim_of(like: SplineNetwork, given: Rows, *penalties: float, freedom=None, word_error=0.0):
    if freedom is None:
        freedom = Edges.curved(like.shape).freedom(like)
    return SplineObjective(like, given, given, 99, *penalties, freedom, word_error)


@pytest.mark.parametrize(("word_error", "classes"), [(0.0, False), (0.3, False), (0.0, True)])
@pytest.mark.parametrize("kind", [FLAT, STRAIGHT, CURVED])
def test_derivatives_are_differences(kind: int, word_error: float, classes: bool) -> None:
    """The loss is the sum of squares or, for classes, the cross-entropy of the logits."""
    like, given = network(outputs=3), rows(outputs=3)
    if classes:
        targets = np.eye(3)[np.random.default_rng(2).integers(0, 3, 40)]
        given = replace(given, targets=targets, labelled=True)
    edges = Edges.curved(like.shape).with_kind(1, kind).with_kind(7, min(kind + 1, CURVED))
    freedom = edges.freedom(like)
    aim = aim_of(like, given, 0.3, 0.01, freedom=freedom, word_error=word_error)
    point: Real = np.asarray(np.linalg.lstsq(freedom, like.packed())[0], dtype=np.float64)
    gradient, hessian = aim.gradient_hessian(point)
    outputs = aim.network(point).process(given.inputs)
    slopes = differences(lambda p: aim.network(p).process(given.inputs), point)
    if classes:
        parts = np.exp(outputs) / np.exp(outputs).sum(axis=1, keepdims=True)
        loss = -np.log(parts[given.targets == 1]).sum()
        curves = [(np.diag(row) - np.outer(row, row)) / 2 for row in parts]
    else:
        loss = (((outputs - given.targets) / given.scale) ** 2).sum()
        curves = [np.diag(1 / row**2) for row in given.scale]
    np.testing.assert_allclose(2 * gradient, differences(aim.value, point), atol=1e-6)
    if not word_error:
        assert aim.value(point) == pytest.approx(loss + point @ aim.stiffness @ point)
        by_rows = zip(np.moveaxis(slopes, 0, -1), curves, strict=True)
        expected = sum(by_row.T @ curve @ by_row for by_row, curve in by_rows) + aim.stiffness
        np.testing.assert_allclose(hessian, expected, atol=1e-6)


def test_errors_of_words_are_expected_in_the_objective() -> None:
    """The objective is what it is on average when the hidden sums of its rows are disturbed."""
    like, given, part = network(), rows(), 1e-3
    plain, aim = (aim_of(like, given, 0, 1e-6, word_error=own) for own in (0.0, part))
    point = like.packed()
    sums = like.sums(like.spread(given.inputs))
    outputs = like.process(given.inputs)
    rng = np.random.default_rng(3)
    drawn = sums + part * np.ptp(sums, axis=0) * rng.normal(size=(4000, *sums.shape))
    disturbed = np.einsum("...hk,ohk->...o", like.hidden.at(drawn)[0], like.second) + like.biases
    added = ((disturbed - outputs) / given.scale) ** 2
    mean = added.sum(axis=(1, 2)).mean()
    assert aim.value(point) - plain.value(point) == pytest.approx(mean, rel=0.05)


def test_a_descent_ends_lower_and_early() -> None:
    like = network(2, 1)
    given, start = curve(60, 1), like.packed()
    aim = aim_of(like, given, 1e-3, 1e-6)
    end = normal_equations(aim, start, 50)
    assert aim.value(end) < 0.05 * aim.value(start)
    np.testing.assert_array_equal(normal_equations(aim, start, 0), start)
    # The other rows are those of the start, so any step leads away from them.
    here = replace(given, targets=like.process(given.inputs))
    watched = replace(aim, validation=here, patience=3)
    assert (watched.search(normal_equations, start, 50) == start).all()
    assert watched._in_vain == watched.patience


def test_a_law_is_learnt_and_pruned(monkeypatch) -> None:
    """The functions of the input that tells nothing become flat, and the error stays."""
    training, validation, test = (curve(120, seed, 0.01) for seed in (1, 2, 3))
    settings = SplineSettings(1, 4, 1e-3)
    found = min(
        (
            trained(settings, np.random.default_rng(start), training, validation)
            for start in range(3)
        ),
        key=lambda model: rms(model, validation),
    )
    assert rms(found, test) < 0.03
    less = pruned(found, training, validation)
    assert less.edges.kinds.sum() < found.edges.kinds.sum()
    assert less.edges.first[0, 2] == FLAT
    assert rms(less, test) < 1.1 * rms(found, test)
    monkeypatch.setattr(splines, "COST", 0.0)
    assert pruned(found, training, validation) is found
    again = less.descended(less.edges, validation, validation)
    assert again.edges is less.edges
    assert rms(again, validation) < rms(less, validation)


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
    stories = [read_provenance(path) for path in scene.weights_paths]
    assert sum(story["curved_edges"] for story in stories) == len(twin.graph.functions) > 0
    for number, story in enumerate(stories):
        assert story["functions"] == "spline"
        assert story["candidates"] == 3
        assert story["every_rms_percent"] < 1
        stages = Stages(scene)
        for one in stories[: number + 1]:
            stages.add((2,), one["best_restart"])
        task = stages.task(stages.written, number)
        error = bit_true_error(task, stages.written[number], task.recorded)
        assert story["every_rms_percent"] == pytest.approx(error, abs=2e-4)


@pytest.mark.parametrize(("key", "value"), [("weight_decay", 1.0), ("steps", 2)])
def test_a_descent_is_that_of_the_scene(scene: Scene, key: str, value: float) -> None:
    task = Stages(scene).task([], 0)
    other = replace(scene, training=replace(scene.training, **{key: value}))
    found = [train(one, (2,), 0).network.packed() for one in (task, replace(task, scene=other))]
    assert not np.array_equal(*found)


@pytest.mark.parametrize("intervals", [0, 2])
def test_what_hardware_gets_is_what_was_trained(intervals: int) -> None:
    """Within the range of training, the layers are the trained functions; beyond, they are held."""
    rng = np.random.default_rng(2)
    inputs = rng.uniform(-0.4, 0.6, (200, 3))
    target = (inputs[:, :1] ** 2 + 0.5 * inputs[:, 1:2]) * (0.4 + inputs[:, 2:])
    rows = Rows(inputs, target, np.ones_like(target))
    learned = splines.trained(SplineSettings(2, intervals, 0.01), rng, rows, rows)
    learned = splines.pruned(learned, rows, rows)
    network = function_network(learned, inputs, 0).layers()
    assert np.abs(network.process(inputs) - learned.process(inputs)).max() < 1e-9
    far = network.process(rng.uniform(-1, 1, (500, 3)))
    assert np.abs(far).max() < 3


def test_sums_with_straight_functions_behind_them_become_one() -> None:
    rng = np.random.default_rng(4)
    inputs = rng.uniform(-0.4, 0.6, (200, 3))
    target = np.sin(3 * inputs[:, :1]) + inputs[:, 1:2] ** 2
    rows = Rows(inputs, target, np.ones_like(target))
    learned = splines.trained(SplineSettings(4, 2, 0.01), rng, rows, rows)
    edges = learned.edges
    edges = replace(edges, second=np.array([[STRAIGHT, CURVED, STRAIGHT, STRAIGHT]]))
    edges = replace(edges, first=np.where(np.eye(4, 3) > 0, FLAT, edges.first))
    learned = learned.descended(edges, rows, rows)
    found = splines.merged(learned)
    assert found.network.shape == (3, 2, 1)
    assert found.edges.second.tolist() == [[STRAIGHT, CURVED]]
    assert found.edges.first.tolist() == [[CURVED] * 3, [CURVED, FLAT, CURVED]]
    assert np.abs(found.process(inputs) - learned.process(inputs)).max() < 1e-9
    assert splines.merged(found) is found
    # Trained further, it stays what it is: the function of the sum is straight.
    assert np.abs(found.descended(found.edges, rows, rows).process(inputs) - target).max() < 0.2


RINGS = """
[data]
file = "rings.csv"
sensors = ["a", "b"]
classes = "ring"
[network]
arrangement = "single"
weights = "rings.npz"
[hardware]
design = "table_graph"
argmax = true
sample_bits = 8
hidden_bits = 8
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


def rings(folder: Path) -> Scene:
    """Points in a disc and in two rings around it, which one sum of parabolas tells apart."""
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.7, 0.7, (180, 2))
    radius = np.sqrt((points**2).sum(axis=1))
    labels = np.array(["disc", "inner", "outer"])[np.digitize(radius, (0.35, 0.55))]
    lines = [f"{a:.4f},{b:.4f},{label}" for (a, b), label in zip(points, labels, strict=True)]
    (folder / "rings.csv").write_text("\n".join(["a,b,ring", *lines]) + "\n")
    path = folder / "rings.toml"
    path.write_text(RINGS)
    return load_scene(str(path))


@pytest.mark.all_only
def test_it_learns_classes(tmp_path: Path) -> None:
    """The decisions of the hardware are those of the file, and hardly any is wrong."""
    scene = rings(tmp_path)
    command.train_scene(scene, tmp_path / "build", 1)
    scene = load_scene(str(scene.path))
    story = read_provenance(scene.weights_paths[0])
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
    scene = rings(tmp_path)
    options = {**scene.design_options, "hidden_bits": 99}
    found = measure(Stages(replace(scene, design_options=options)).task([], 0), (1,), 0)
    assert found.validation == float("inf")
    assert "hidden_bits: got 99" in found.refused
