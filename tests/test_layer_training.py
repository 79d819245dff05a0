"""Training of networks whose layers the scene names."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine
from derivatives import check_derivatives
from refused import call

from golden.activation.segments import gradient_real
from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.trained.dense import ACTIVATIONS, Trained, layers_of, network_of, packed
from golden.trained.function import Function
from golden.trained.mlp import Activation, tanh
from tactus.errors import held_out_rows
from tactus.network_files.network_file import read_provenance
from tactus.rig.check import design
from tactus.scene import load_scene
from tactus.train import candidate_runs, search
from tactus.train.objective import Objective, Rows
from tactus.train.task import task_for
from tb.common.cases import random_network


def objective(network: Trained, of_tanh: Activation) -> Objective:
    rng = np.random.default_rng(3)
    inputs, outputs = network.shape[0], network.shape[-1]
    parts = [
        Rows(
            rng.normal(0, 1, (n, inputs)), rng.normal(0, 1, (n, outputs)), np.full((n, outputs), 2)
        )
        for n in (7, 5)
    ]
    return Objective(network, of_tanh, *parts, 1e-3, 9)


def leaky(network: Trained) -> Trained:
    """Every leaky ReLU with a slope that shows."""
    return network_of([replace(layer, leak=0.3) for layer in layers_of(network)])


OWN = Function("wave", "sin(2 * x)"), Function("bell", "exp(-x * x)")
NETWORKS = [
    leaky(random_network((3, 4, 2), (kind,), 1.0, seed)) for seed, kind in enumerate(ACTIVATIONS)
] + [
    leaky(random_network((2, 4, 3, 5, 2), ("relu", "sigmoid", "leaky_relu"), 1.0, 9)),
    random_network((2, 3, 4, 2), ("table:wave,bell,wave", "table:bell"), 1.0, 4, functions=OWN),
]


@pytest.mark.parametrize("of_tanh", [tanh, gradient_real])
@pytest.mark.parametrize("network", NETWORKS, ids=lambda n: "-".join(map(str, n.shape)))
def test_gradient_and_jacobian_are_the_differences(network: Trained, of_tanh: Activation) -> None:
    aim, point = objective(network, of_tanh), packed(network)
    check_derivatives(aim, point)
    slopes = aim.jacobian(point)
    assert np.allclose(aim.curvature(point), 2 * slopes.T @ slopes)


def scene_of(tmp_path: Path, more: str = "") -> Path:
    """Targets that a network of two hidden layers gives, on 60 random frames."""
    teacher = random_network((3, 4, 4, 2), ("relu", "relu"), 1.0, 4)
    path = on_engine(tmp_path, [teacher])
    rng = np.random.default_rng(5)
    x = SIGNAL.to_real(rng.integers(SIGNAL.low, SIGNAL.high, (60, 3)))
    rows = [",".join(map(repr, row.tolist())) for row in np.hstack([x, teacher.process(x) / 8])]
    path.with_suffix(".csv").write_text("\n".join(["x0,x1,x2,y0,y1", *rows]))
    scale = 'full_scale = { y0 = 1, y1 = 1 }\ngroup_by = ""'
    path.write_text(path.read_text().replace('group_by = "y0"', scale) + more)
    for file in tmp_path.glob("mine*.npz"):
        file.unlink()
    return path


def trained(path: Path) -> None:
    call("train", path, "--workers", 1, "--build", path.parent / "build")


def test_a_scene_of_several_layers_is_trained(tmp_path: Path) -> None:
    path = scene_of(tmp_path)
    text = path.read_text().replace("[4, 4]", '[4, 4]\nactivations = ["relu", "relu"]')
    path.write_text(text.replace("steps = 20", "steps = 100"))
    trained(path)
    scene = load_scene(str(path))
    assert scene.describe() == "3:4:4:2"
    assert scene.networks()[0].activations == ("relu", "relu")
    story = read_provenance(scene.weights_paths[0])
    assert story is not None
    assert (story["network"], story["hidden"]) == ("3:4:4:2", "4 relu, 4 relu")
    assert story["test_rms_percent"] < 5
    # What it was not trained on is known.
    rows = held_out_rows(scene)
    assert rows is not None
    miss = scene.vectors().percent_errors(
        SIGNAL.to_real(scene.twin().process(scene.vectors().codes))
    )[rows]
    assert abs(np.sqrt((miss**2).mean()) - story["test_rms_percent"]) < 1e-3
    before = (tmp_path / "mine.npz").read_bytes()
    trained(path)
    assert (tmp_path / "mine.npz").read_bytes() == before


def test_layers_are_searched_where_the_scene_asks(tmp_path: Path) -> None:
    """One hidden layer of two nodes is too few for what two layers of four made."""
    path = scene_of(tmp_path, 'layers = [1, 2]\nactivation = "relu"\n')
    text = path.read_text().replace("hidden = [4, 4]\n", "")
    path.write_text(text.replace("steps = 20", "steps = 60\nhidden = [2, 5]"))
    trained(path)
    scene = load_scene(str(path))
    story = read_provenance(scene.weights_paths[0])
    assert story is not None
    assert story["hidden"] == "1 to 2 layers of 2, 3, 4, 5 relu"
    assert story["candidates"] == 8 * scene.training.restarts
    # The candidate that was chosen is trained again on its own, and is better than the least one.
    task = task_for(scene, scene.vectors(), [])
    found = {one: search.measure(task, *one) for one in search.candidates(task)}
    best = min(found.values(), key=lambda c: c.rank)
    assert story["network"] == ":".join(map(str, (3, *best.layers, 2)))
    assert story["best_restart"] == best.restart
    assert abs(story["validation_rms_percent"] - best.validation) < 1e-3
    assert best.validation < found[(2,), 0].validation
    assert scene.networks()[0].activations == ("relu",) * len(best.layers)


def test_with_many_rows_the_worse_half_ends_early_and_an_interrupted_search_goes_on(
    tmp_path: Path, monkeypatch
) -> None:
    path = scene_of(tmp_path)
    text = path.read_text().replace("[4, 4]", "0").replace('"single"', '"cascade"')
    text = text.replace('weights = "mine.npz"', 'weights = ["mine-0.npz", "mine-1.npz"]')
    path.write_text(text.replace("steps = 20", "steps = 20\nhidden = [2, 6]"))
    monkeypatch.setattr(search, "MANY_ROWS", 59)
    monkeypatch.setattr(candidate_runs, "FIRST_ROWS", 10)
    measure, seen = search.measure, []

    def watched(task, hidden, restart, *point):
        if len(seen) == 11:
            raise KeyboardInterrupt
        result = measure(task, hidden, restart, *point)
        seen.append((task.number, len(task.training.inputs), (hidden, restart, *point), result))
        return result

    monkeypatch.setattr(search, "measure", watched)
    with pytest.raises(KeyboardInterrupt):
        trained(path)
    seen.append((None, 0, (), None))
    trained(path)
    for number, name in enumerate(("mine-0.npz", "mine-1.npz")):
        rows: dict[int, list] = {}
        begun = set()
        for _, count, candidate, result in (one for one in seen if one[0] == number):
            rows.setdefault(count, []).append(result)
            begun.add(candidate)
        assert {count: len(found) for count, found in rows.items()} == {10: 10, 20: 5, 30: 3}
        better = sorted(rows[10], key=lambda result: result.rank)[:5]
        # They go on from the weights that they have reached.
        assert {one.candidate for one in better} < begun
        story = read_provenance(tmp_path / name)
        best = min(rows[30], key=lambda result: result.rank)
        assert abs(story["validation_rms_percent"] - best.validation) < 1e-3


def test_a_search_for_layers_beside_fixed_activations_is_refused(tmp_path: Path) -> None:
    path = scene_of(tmp_path, "layers = [1, 2]\n")
    path.write_text(path.read_text().replace("hidden = [4, 4]", 'activations = ["relu"]'))
    message = "mine.toml: training.layers: got [1, 2] with network.activations ['relu'], expected"
    with pytest.raises(InputError, match=re.escape(message)):
        load_scene(str(path))


@pytest.mark.parametrize(("least", "verdict"), [(1, "warning"), (2, "fault")])
def test_a_search_is_checked_before_it_begins(tmp_path: Path, least: int, verdict: str) -> None:
    """A hybrid has one hidden layer, so two are too many for it."""
    path = scene_of(tmp_path, f"layers = [{least}, 2]\n")
    text = path.read_text().replace("hidden = [4, 4]", "").replace('"engine"', '"hybrid"')
    path.write_text(text)
    found = design(load_scene(str(path)), trained=False)
    assert [finding.verdict for finding in found] == [verdict]
    nodes = "4:4" if verdict == "fault" else "25:25"
    assert found[0].text.startswith(f"with {nodes} hidden nodes: ")
