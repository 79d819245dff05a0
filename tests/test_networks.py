"""Whole networks: bit-true against float, extreme weights, and the figures of the thesis."""

from __future__ import annotations

import hashlib
import tomllib

import numpy as np
import pytest
from conftest import random_mlp
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.activation.segments import gradient_real
from golden.block import walk
from golden.metrics import percent_errors, summarise
from golden.networks.build import build_hybrid
from golden.networks.mlp import Mlp
from golden.precision import PRECISE, PRECISIONS, SIGNAL, THESIS, normalisation
from golden.scene import FOLDER, load_scene, scene_names

SCENES = scene_names()


def largest_means(scene, results):
    vectors = scene.vectors()
    errors = percent_errors(results, vectors.targets, scene.outputs, scene.full_scale)
    return np.array([e.largest_mean for e in summarise(errors, vectors.groups)])


def bit_true(scene):
    return SIGNAL.to_real(scene.design().process(scene.vectors().codes))


@pytest.mark.parametrize("name", SCENES)
def test_no_worse_than_the_simulated_hybrid_of_the_thesis(name: str) -> None:
    numbers = tomllib.loads((FOLDER.parent / "data" / "thesis_numbers.toml").read_text())
    scene = load_scene(name)
    assert (largest_means(scene, bit_true(scene)) <= numbers["digit"]["hybrid"]["simulation"]).all()


def test_precise_costs_next_to_nothing() -> None:
    """Against the same network with the same activation in real arithmetic."""
    scene = load_scene("digit-single")
    real = scene.mlp().process(scene.vectors().inputs, scene.scheme.real)
    assert (largest_means(scene, bit_true(scene)) <= 1.05 * largest_means(scene, real)).all()


def test_thesis_normalisation_is_equation_4_16() -> None:
    weights = np.array([[0.2, -1.5, 0.0], [0.0, 0.0, 0.0]])
    assert normalisation(weights, np.array([2.0, 0.0])).tolist() == [5, 1]


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from(sorted(PRECISIONS)), st.floats(0.2, 2.0))
def test_bit_true_follows_float(seed: int, name: str, spread: float) -> None:
    shape = (4, 6, 2)
    mlp = random_mlp(shape, spread, seed)
    frames = np.random.default_rng(seed).integers(SIGNAL.low, SIGNAL.high + 1, (200, 4))
    design = build_hybrid(mlp, PRECISIONS[name], "gradient")
    results = SIGNAL.to_real(design.process(frames))
    exact = np.clip(mlp.process(SIGNAL.to_real(frames), gradient_real), -1, SIGNAL.high / 8192)
    # One LSB of a weight, a product or q in each term, carried to the output by its weights. A q
    # that falls on the other side of a border adds the scheme's step there: 126 LSB at 0, where
    # the first intercept changes its sign, and 44 at the most elsewhere.
    if name == "precise":
        bound = (3 + np.abs(mlp.w2).sum(axis=1) * 130) / 8192
    else:
        y = normalisation(mlp.w2, mlp.b2)
        q = normalisation(mlp.w1, mlp.b1).max()
        bound = (y * 10 + np.abs(mlp.w2).sum(axis=1) * (8 * q + 130)) / 8192
    assert (np.abs(results - exact) <= bound).all()


@pytest.mark.parametrize("precision", PRECISIONS.values(), ids=lambda p: p.name)
def test_rails_on_all_sensors(precision) -> None:
    mlp = random_mlp((4, 6, 2), 3.0, 3)
    design = build_hybrid(mlp, precision, "gradient")
    rails = np.array(np.meshgrid(*[[SIGNAL.low, 0, SIGNAL.high]] * 4)).reshape(4, -1).T
    results = design.process(rails)
    assert results.min() >= SIGNAL.low
    assert results.max() <= SIGNAL.high


def test_shapes_and_chunks_change_nothing() -> None:
    design = build_hybrid(random_mlp((3, 4, 2), 1.0, 1), PRECISE, "gradient")
    frames = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (3, 3001, 3))
    results = design.process(frames)
    assert results.shape == (3, 3001, 2)
    assert np.array_equal(results[2, 3000], design.process(frames[2, 3000]))
    assert design.process(np.empty((0, 3), dtype=np.int64)).shape == (0, 2)
    with pytest.raises(ValueError, match=r"hybrid frames: got shape \(4,\), expected \(..., 3\)"):
        design.process([1, 2, 3, 4])
    with pytest.raises(ValueError, match="got dtype float64, expected integer codes"):
        design.process([0.0, 0.1, 0.2])


def test_huge_weights_still_build() -> None:
    """Q_j of several hundred, and weights that leave 18 bits few fraction bits."""
    rng = np.random.default_rng(0)
    mlp = Mlp(rng.normal(0, 60, (3, 4)), rng.normal(0, 60, 3), np.ones((1, 3)) * 0.3, np.zeros(1))
    for precision in (THESIS, PRECISE):
        design = build_hybrid(mlp, precision, "gradient")
        frames = rng.integers(SIGNAL.low, SIGNAL.high + 1, (500, 4))
        assert np.abs(design.process(frames)).max() <= -SIGNAL.low


def test_weights_beyond_the_format_are_refused() -> None:
    mlp = Mlp(np.full((1, 1), 2e5), np.zeros(1), np.ones((1, 1)), np.zeros(1))
    with pytest.raises(ValueError, match="layer 1 weights: largest magnitude 200000 does not fit"):
        build_hybrid(mlp, PRECISE, "gradient")


def test_a_thesis_sum_that_could_wrap_is_refused() -> None:
    mlp = Mlp(np.full((1, 2), -1.0), np.array([1.0]), np.full((1, 1), 0.3), np.zeros(1))
    with pytest.raises(ValueError, match="hidden node 0: its normalised sum needs 15 bits"):
        build_hybrid(mlp, THESIS, "gradient")


def test_an_input_that_no_weight_reads_changes_nothing() -> None:
    mlp = random_mlp((3, 4, 2), 1.0, 2)
    mlp.w1[:, 1] = 0
    design = build_hybrid(mlp, THESIS, "gradient")
    frames = np.zeros((2, 3), dtype=np.int64)
    frames[1, 1] = SIGNAL.low
    assert np.array_equal(*design.process(frames))


def test_entity_names_are_unique() -> None:
    for name in SCENES:
        entities = [block.entity for block in walk(load_scene(name).design())]
        assert len(set(entities)) == len(entities)


def test_recorded_vectors_are_those_of_their_provenance() -> None:
    folder = FOLDER.parent / "data"
    provenance = tomllib.loads((folder / "appendix2.toml").read_text())
    content = (folder / "appendix2.csv").read_bytes()
    assert hashlib.sha256(content).hexdigest() == provenance["sha256"]
    assert content.count(b"\n") == provenance["rows"] + 1


def test_metrics_on_numbers_done_by_hand() -> None:
    targets = np.array([[0.5, 0.2], [0.5, 0.4], [0.25, 0.4]])
    results = np.array([[0.6, 0.29], [0.5, 0.4], [0.25, 0.58]])
    errors = percent_errors(results, targets, ["load", "position"], {"position": 0.9})
    assert errors == pytest.approx(np.array([[20, 10], [0, 0], [0, 20]]))
    load, position = summarise(errors, [1, 2, 2])
    assert (load.largest_mean, load.worst) == pytest.approx((20, 20))
    assert (position.mean, position.largest_mean) == pytest.approx((10, 10))


def test_a_node_without_weights_still_builds() -> None:
    """Its accumulator is narrower than the half LSB that rounding adds."""
    mlp = random_mlp((2, 3, 1), 0.3, 1)
    mlp.w1[1] = 0
    mlp.b1[1] = 0
    design = build_hybrid(mlp, PRECISE, "gradient")
    node = design.input_integral.nodes[1]
    assert node.acc_width < node.out_shift
    assert design.input_integral.process([[SIGNAL.low, SIGNAL.high]])[0, 1] == 0
