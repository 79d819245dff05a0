"""The trainer: its Jacobian, its split, its determinism, and the networks it shipped."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from conftest import random_mlp

from golden.activation.segments import gradient_real
from golden.metrics import percent_errors
from golden.network_file import provenance_path
from golden.networks.mlp import tanh
from golden.precision import SIGNAL
from golden.scene import Scene, load_scene, scene_names
from golden.training import levenberg_marquardt
from golden.training.levenberg_marquardt import fit, pack, unpack
from golden.training.search import run_restart, split_rows


def test_pack_and_unpack_are_inverse() -> None:
    mlp = random_mlp((3, 4, 2), 1.0, 1)
    again = unpack(pack(mlp), mlp.shape)
    assert all(np.array_equal(getattr(mlp, n), getattr(again, n)) for n in ("w1", "b1", "w2", "b2"))


@pytest.mark.parametrize("activation", [tanh, gradient_real])
def test_the_jacobian_is_the_derivative(monkeypatch, activation) -> None:
    """Caught on its way into SciPy and compared with central differences."""
    caught = {}

    def catch(residuals, start, jacobian, **_):
        caught.update(f=residuals, x=start, j=jacobian)
        raise StopIteration

    monkeypatch.setattr(levenberg_marquardt, "least_squares", catch)
    rng = np.random.default_rng(2)
    inputs, targets = rng.uniform(-1, 1, (7, 3)), rng.uniform(0.1, 1, (7, 2))
    with pytest.raises(StopIteration):
        fit(random_mlp((3, 4, 2), 1.0, 1), inputs, targets, targets, activation, 1e-3, 10)
    x, step = caught["x"], 1e-7
    numeric = np.stack(
        [
            (caught["f"](x + step * e) - caught["f"](x - step * e)) / (2 * step)
            for e in np.eye(len(x))
        ],
        axis=1,
    )
    assert np.allclose(caught["j"](x), numeric, atol=1e-5)


def test_fit_reaches_a_network_it_can_reach() -> None:
    rng = np.random.default_rng(4)
    goal = random_mlp((2, 3, 1), 1.0, 9)
    inputs = rng.uniform(-1, 1, (60, 2))
    targets = goal.process(inputs)
    found = fit(random_mlp((2, 3, 1), 1.0, 1), inputs, targets, np.ones((60, 1)), tanh, 0.0, 2000)
    assert np.abs(found.process(inputs) - targets).max() < 1e-3


def test_the_split_is_50_25_25_and_covers_every_row() -> None:
    split = split_rows(143, 1)
    parts = (split.training, split.validation, split.test)
    assert [len(p) for p in parts] == [71, 35, 37]
    assert sorted(np.concatenate(parts)) == list(range(143))
    assert not np.array_equal(split.training, split_rows(143, 2).training)
    with pytest.raises(ValueError, match="got 7 rows, expected at least 8"):
        split_rows(7, 1)


def test_a_restart_depends_on_seed_and_number_alone(small_scene: Scene) -> None:
    vectors = small_scene.vectors()
    first, again = (run_restart(small_scene, vectors, 1) for _ in range(2))
    assert np.array_equal(pack(first.mlp), pack(again.mlp))
    other = replace(small_scene, training=replace(small_scene.training, seed=9))
    assert not np.array_equal(pack(first.mlp), pack(run_restart(other, vectors, 1).mlp))


@pytest.mark.parametrize("name", scene_names())
def test_shipped_networks_have_the_errors_of_their_provenance(name: str) -> None:
    scene = load_scene(name)
    provenance = tomllib.loads(provenance_path(scene.weights_path).read_text())
    vectors = scene.vectors()
    split = split_rows(len(vectors.inputs), provenance["seed"])
    results = SIGNAL.to_real(scene.design().process(vectors.codes))
    errors = percent_errors(results, vectors.targets, scene.outputs, scene.full_scale)
    for part in ("validation", "test"):
        rms = np.sqrt((errors[getattr(split, part)] ** 2).mean())
        assert rms == pytest.approx(provenance[f"{part}_rms_percent"], abs=1e-3)
