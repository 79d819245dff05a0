"""Graphs of shifted adds beside whole numbers, and designs of them beside real arithmetic."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.layers import sharing
from golden.layers.constant_matrix import ConstantMatrix, Finish
from golden.layers.sharing import shared
from golden.layers.shift_add import Sum
from golden.networks.adder_graph import AdderGraph
from golden.networks.design import Design, Settings
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.oracle import error_bounds, exact
from golden.networks.parallel import Parallel
from golden.numbers.fixed import Fix
from golden.numbers.precision import EXACT, SIGNAL, THESIS, Precision
from golden.numbers.signed_digits import signed_digits
from golden.trained.dense import Dense, DenseNetwork, Quantiser, network_of, tanh
from golden.trained.function import read_function
from golden.trained.function_network import of_parabolas
from tactus.core.store import VARIABLE
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp, random_network
from tb.common.stimulus import corner_frames

pytestmark = pytest.mark.usefixtures("few_runs")


def frames_of(inputs: int) -> np.ndarray:
    random = np.random.default_rng(2).integers(SIGNAL.low, SIGNAL.high + 1, (300, inputs))
    return np.concatenate([corner_frames(SIGNAL, inputs), random])


def off(design: Design, mlp: DenseNetwork) -> np.ndarray:
    """The distance of the outputs from real arithmetic that saturates, in real units."""
    frames = frames_of(design.inputs)
    real = mlp.process(SIGNAL.to_real(frames), tanh)
    ends = SIGNAL.to_real([SIGNAL.low, SIGNAL.high])
    results = SIGNAL.to_real(design.process(frames))
    return np.abs(results - np.clip(real, *ends))


@pytest.mark.parametrize(("spread", "seed"), [(0.3, 6), (1.0, 4), (2.0, 5)])
@pytest.mark.parametrize(
    ("design", "precision", "activation"),
    [
        (AdderGraph, EXACT, "bipartite"),
        *((one, EXACT, name) for one in (Hybrid, Parallel) for name in ("precise", "gradient")),
        *((one, THESIS, "gradient") for one in (Hybrid, Parallel)),
    ],
)
def test_a_bound_holds_where_a_node_is_not_built(
    design: type[Design], precision: Precision, activation: str, spread: float, seed: int
) -> None:
    mlp = random_mlp((3, 5, 2), spread, seed)
    mlp.layers[1].weights[:, [0, 3]] = 1e-7
    built = design.of([mlp], Settings(precision, activation))
    assert built.useless_nodes == 2
    assert (off(built, mlp) <= error_bounds(built, mlp, precision, 3)).all()


def narrow(width: int) -> Settings:
    """Settings with so many bits of a word from layer to layer."""
    return Settings(EXACT, "bipartite", options={"word_width": width})


CODES = Quantiser(2.0**-3, 0, 0, 15)
BUILT = [
    ((1, 1, 1), ("tanh",), 1.0),
    ((3, 4, 2), ("tanh",), 20.0),
    ((5, 3, 4), ("tanh",), 0.3),
    ((4, 3), (), 1.0),
    ((3, 5, 2), ("relu",), 1.0),
    ((3, 4, 3, 2), ("leaky_relu", "hard_tanh"), 1.0),
    ((3, 4, 3, 2), ("tanh", "relu"), 1.0),
    ((2, 4, 3, 3, 1), ("relu", "sigmoid", "linear"), 1.0),
]


@pytest.mark.parametrize(("shape", "kinds", "spread"), BUILT)
def test_outputs_are_within_their_bounds(
    shape: tuple[int, ...], kinds: tuple[str, ...], spread: float
) -> None:
    network = random_network(shape, kinds, spread, 3)
    design = AdderGraph.of([network], Settings(EXACT, "bipartite"))
    assert len(design.layers) == len(shape) - 1
    bounds = error_bounds(design, network, EXACT, shape[0])
    assert (off(design, network) <= bounds).all()
    frames = frames_of(design.inputs)
    assert (exact(design, frames) == design.process(frames)).all()


@pytest.mark.parametrize(
    ("width", "said"), [(15, "Fix(15,4) hold"), (5, "Fix(5,0) in units of 64 hold")]
)
def test_what_a_word_holds_is_the_same_for_any_width(width: int, said: str) -> None:
    """A short word of a wide range stands for multiples of a number above 1."""
    network = random_network((3, 4, 2), ("relu",), 300.0, 3)
    design = AdderGraph.of([network], narrow(width))
    (found,) = design.ranges
    assert said in found.text, found.text
    assert float(found.text.split("hold ")[1].split(",")[0]) == pytest.approx(1024, rel=0.1)


@pytest.mark.parametrize("rounding", ["even", "away", "floor"])
@pytest.mark.parametrize("kinds", [("relu", "relu"), ("linear", "linear")])
def test_a_quantised_network_is_that_of_the_engine(rounding: str, kinds: tuple[str, ...]) -> None:
    """No bit of any sum is cut, so ties are where they are in the integer network."""
    quantiser = replace(CODES, rounding=rounding)
    network = random_network((3, 5, 4, 3), kinds, 2.0, 12, quantiser)
    design = AdderGraph.of([network], Settings(EXACT, "bipartite"))
    frames = frames_of(3)
    assert (design.process(frames) == Engine.of([network]).process(frames)).all()
    assert all(matrix.place == 0 for matrix in design.layers)
    even = [finish.even for matrix in design.layers[:-1] for finish in matrix.row_finishes]
    assert any(even) == (rounding == "even")


def test_a_scene_of_layers_needs_no_activation(tmp_path: Path) -> None:
    network = random_network((2, 3, 3, 2), ("relu", "relu"), 1.0, 1)
    path = write_scene(tmp_path, "deep", "exact", [network], design="adder_graph")
    path.write_text(path.read_text().replace('activation = "gradient"\n', ""))
    scene = load_scene(str(path))
    assert scene.activation == "bipartite"
    frames = frames_of(2)
    assert (scene.twin().process(frames) == scene.twin(lean=False).process(frames)).all()


def test_nodes_that_never_change_are_part_of_biases() -> None:
    """Of five nodes, one is never positive, one is constant, and no output uses a third."""
    weights = np.array([[0.5, 0.1], [0.3, -0.2], [0.0, 0.0], [-0.4, 0.2], [0.6, 0.3]])
    first = Dense(weights, np.array([0.1, -0.9, 0.7, 0.2, 0.0]), "relu")
    second = Dense(np.array([[0.5, 0.3, 0.25, -0.5, 0.0]]), np.array([0.1]))
    design = AdderGraph.of([network_of([first, second])], Settings(EXACT, "bipartite"))
    assert (design.constant_nodes, design.useless_nodes) == (2, 1)
    assert len(design.layers[0].weights) == design.layers[1].inputs == 2
    texts = design.left_out()
    assert "2 hidden nodes that never change, now in biases" in texts
    assert "1 hidden nodes whose weights to the outputs are 0" in texts
    kept = [0, 3]
    small = [
        Dense(weights[kept], first.biases[kept], "relu"),
        Dense(second.weights[:, kept], second.biases + 0.7 * 0.25),
    ]
    other = AdderGraph.of([network_of(small)], Settings(EXACT, "bipartite"))
    frames = frames_of(2)
    assert np.abs(design.process(frames) - other.process(frames)).max() <= 1


def test_what_it_cannot_compute_is_refused_by_name() -> None:
    swish = read_function("swish", "x / (1 + exp(-x))")
    network = random_network((2, 3, 1), ("table: swish",), 1.0, 1, functions=(swish,))
    with pytest.raises(InputError, match=r"layer 1: .*'adder_graph' with the functions swish, exp"):
        AdderGraph.of([network], Settings(EXACT, "bipartite"))
    deep = [random_network((2, 3, 3, 1), ("relu", "relu"), 1.0, seed) for seed in (1, 2)]
    with pytest.raises(InputError, match="got 'adder_graph' for hidden layers of relu, relu, exp"):
        AdderGraph.of(deep, Settings(EXACT, "bipartite"), "multiple")
    many = of_parabolas((3, 2, 1), 0).layers()
    with pytest.raises(InputError, match="for hidden layers of 6 functions, table:g1_1,g1_2, exp"):
        Hybrid.of([many], Settings(EXACT, "gradient"))
    for kinds, quantiser in ((("tanh",), None), (("tanh", "sigmoid"), None), (("relu",), CODES)):
        shape = (2, *(3 for _ in kinds), 1)
        network = random_network(shape, kinds, 1.0, 1, quantiser)
        with pytest.raises(InputError, match=r"hardware.word_width: got 8, expected none: .*table"):
            AdderGraph.of([network], narrow(8))
    design = AdderGraph.of(deep[:1], Settings(EXACT, "bipartite"))
    with pytest.raises(InputError, match="argmax: got outputs=1, expected 2 or more"):
        replace(design, decides=True)


SAMPLES = Fix(6, 5)
WIDE = Fix(40, 5)
WEIGHT = st.integers(-(1 << 11), 1 << 11)


@st.composite
def matrices(draw: st.DrawFn) -> ConstantMatrix:
    """Small matrices of any shape, in which some weights are 0."""
    inputs, rows = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    weights = draw(
        st.lists(
            st.lists(st.one_of(st.just(0), WEIGHT), min_size=inputs, max_size=inputs),
            min_size=rows,
            max_size=rows,
        )
    )
    biases = draw(st.lists(st.integers(-(1 << 16), 1 << 16), min_size=rows, max_size=rows))
    return ConstantMatrix(
        SAMPLES,
        WIDE,
        tuple(map(tuple, weights)),
        tuple(biases),
        draw(st.integers(0, 8)),
        draw(st.integers(0, 3)),
        draw(st.integers(1, 6)),
        adder_operands=draw(st.sampled_from([2, 3])),
    )


def products(matrix: ConstantMatrix, frames: np.ndarray) -> np.ndarray:
    """The exact sums, in Python's integers."""
    return frames.astype(object) @ np.array(matrix.weights, dtype=object).T + np.array(
        matrix.biases, dtype=object
    )


def some_frames(matrix: ConstantMatrix) -> np.ndarray:
    """Frames for the ends of each sum, and random frames."""
    fmt, signs = matrix.in_fmt, np.array(matrix.weights) < 0
    ends = np.concatenate([np.where(one, fmt.low, fmt.high) for one in (signs, ~signs)])
    random = np.random.default_rng(3).integers(fmt.low, fmt.high + 1, (40, matrix.inputs))
    return np.concatenate([ends, random])


def test_a_graph_of_a_large_matrix_is_kept(tmp_path: Path, monkeypatch) -> None:
    """So is one of a given number of runs; that of a small matrix is found anew."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    weights = tuple(tuple(4 * i + j + 1 for j in range(4)) for i in range(8))
    large = ConstantMatrix(SAMPLES, WIDE, weights, (0,) * 8, 6, 1, 4)
    assert sum(map(len, weights)) == sharing.LEAST_WEIGHTS
    fewer = replace(large, weights=weights[:-1], biases=(0,) * 7)
    shared.cache_clear()
    kept = [large, replace(fewer, search_runs=3)]
    graphs = [matrix.graph for matrix in kept]
    assert fewer.graph
    assert len(list(tmp_path.rglob("*.json"))) == 2
    with monkeypatch.context() as patch:
        patch.setattr(sharing, "shared", pytest.fail)
        assert [replace(matrix).graph for matrix in kept] == graphs


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_nothing_cut_is_the_exact_product(matrix: ConstantMatrix) -> None:
    whole = replace(matrix, guard=matrix.out_shift)
    frames = some_frames(whole)
    assert (whole.process(frames) == products(whole, frames) >> whole.out_shift).all()
    assert set(whole.errors) == {(0, 0)}


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_what_is_cut_is_within_its_bounds(matrix: ConstantMatrix) -> None:
    frames = some_frames(matrix)
    exact, results = products(matrix, frames), matrix.process(frames)
    for i, (below, above) in enumerate(matrix.errors):
        assert (results[:, i] >= (exact[:, i] + below) >> matrix.out_shift).all()
        assert (results[:, i] <= (exact[:, i] + above) >> matrix.out_shift).all()


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_sharing_takes_no_more_adders_than_the_digits(matrix: ConstantMatrix) -> None:
    sums = sum(isinstance(node, Sum) for node in matrix.graph.nodes)
    # These are the digits of a row and of its constant.
    alone = sum(sum(len(signed_digits(w)) for w in row) for row in matrix.weights)
    assert sums <= alone


def test_results_saturate() -> None:
    matrix = ConstantMatrix(SAMPLES, Fix(4, 5), ((3, -2),), (0,), 2, 2, 4)
    frames = some_frames(matrix)
    expected = np.clip(products(matrix, frames) >> 2, -8, 7)
    assert (matrix.process(frames) == expected).all()
    assert {-8, 7} <= set(matrix.process(frames).ravel().tolist())
    rectified = replace(matrix, finishes=(Finish(rectified=True),))
    assert (matrix.result_ends, rectified.result_ends) == (((-8, 7),), ((0, 7),))


def test_what_it_cannot_be_is_refused() -> None:
    matrix = ConstantMatrix(SAMPLES, WIDE, ((1, 2), (3, 4)), (0, 0), 4, 2, 4)
    with pytest.raises(InputError, match="got adder_operands=4, expected 2 to 3"):
        replace(matrix, adder_operands=4)
    with pytest.raises(InputError, match="got sums of 67 bits, expected 62 at most"):
        replace(matrix, weights=((1, 2), (3, 1 << 60)))
