"""Networks of several hidden layers: in files, in scenes, and on the engine."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import onnx
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator
from test_engine import random_codes

from golden.input_error import InputError
from golden.networks.bounds import engine_bounds
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.networks.oracle import exact
from golden.numbers.precision import SIGNAL
from golden.trained.dense import ACTIVATIONS, Dense, DenseNetwork, Trained, layers_of, network_of
from tactus.network_files.network_file import load_network, write_network
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_network


def random(shape: tuple[int, ...], kinds: tuple[str, ...], seed: int = 1, spread: float = 1.0):
    return random_network(shape, kinds, spread, seed)


def same(one: Trained, other: Trained) -> bool:
    return type(one) is type(other) and all(
        np.array_equal(a.weights, b.weights)
        and np.array_equal(a.biases, b.biases)
        and a.activation_text == b.activation_text
        for a, b in zip(layers_of(one), layers_of(other), strict=True)
    )


# In files.


@pytest.mark.parametrize("form", [".npz", ".onnx"])
@pytest.mark.parametrize(
    ("shape", "kinds"),
    [
        ((3, 4, 5, 2), ("relu", "tanh")),
        ((2, 3, 1), ("sigmoid",)),
        ((3, 2, 4, 3, 2), ("leaky_relu", "hard_tanh", "linear")),
    ],
)
def test_a_file_gives_the_same_network_back(tmp_path: Path, form, shape, kinds) -> None:
    network = random(shape, kinds)
    write_network(tmp_path / f"net{form}", network)
    for asked in (shape, (shape[0], 0, shape[-1])):
        assert same(load_network(tmp_path / f"net{form}", asked), network)


def test_the_slope_of_a_leaky_relu_is_kept(tmp_path: Path) -> None:
    first, *others = random((3, 4, 5, 2), ("leaky_relu", "relu")).layers
    leaky = Dense(first.weights, first.biases, "leaky_relu", 0.25)
    network = network_of([leaky, *others])
    for form in (".npz", ".onnx"):
        write_network(tmp_path / f"net{form}", network)
        found = load_network(tmp_path / f"net{form}", (3, 4, 5, 2))
        assert isinstance(found, DenseNetwork)
        assert found.layers[0].leak == 0.25
    (results,) = ReferenceEvaluator(str(tmp_path / "net.onnx")).run(None, {"x": np.eye(3)})
    assert np.allclose(results, network.process(np.eye(3)), atol=1e-14)


def test_arrays_of_an_npz_that_do_not_go_together(tmp_path: Path) -> None:
    arrays = {f"w{n}": np.ones((2, 2)) for n in (1, 2, 3)} | {
        f"b{n}": np.ones(2) for n in (1, 2, 3)
    }
    for more, message in (
        ({}, "got an array 'w3' and 1 activations, expected an activation for each layer but"),
        ({"activations": np.array([1, 2])}, "activations: got int64 of shape"),
        (
            {"activations": np.array(["relu", "rellu"])},
            "layer 2: activation: got 'rellu', expected",
        ),
        (
            {"activations": np.array(["relu", "leaky_relu"]), "leaks": np.array([0.1])},
            "leaks: got 1 numbers, expected 2",
        ),
        (
            {"activations": np.array(["relu", "leaky_relu"]), "leaks": np.array([9, 9])},
            "layer 2: leak: got 9.0, expected 0 to 1",
        ),
        ({"activations": np.array(["relu"] * 3)}, "no array 'w4', got w1"),
    ):
        np.savez(tmp_path / "net.npz", **arrays, **more)
        with pytest.raises(InputError, match=f"net.npz: {message}"):
            load_network(tmp_path / "net.npz", (2, 0, 2))


# From elsewhere: ONNX, judged by ONNX's own reference implementation.


def graph(tmp_path: Path, nodes, constants, inputs: int = 3) -> Path:
    made = helper.make_graph(
        nodes,
        "test",
        [helper.make_tensor_value_info("x", TensorProto.DOUBLE, [None, inputs])],
        [helper.make_tensor_value_info("y", TensorProto.DOUBLE, [None, None])],
        [numpy_helper.from_array(np.asarray(v), k) for k, v in constants.items()],
    )
    path = tmp_path / "net.onnx"
    onnx.save(helper.make_model(made, opset_imports=[helper.make_opsetid("", 17)]), str(path))
    return path


def node(kind: str, inputs: str, output: str, **attributes):
    taken = [name.replace("-", "") for name in inputs.split()]
    return helper.make_node(kind, taken, [output], name=f"my_{kind}", **attributes)


def chain(*activations) -> list:
    """Three layers as Keras writes them, the nodes of each activation behind the first two."""
    nodes, value = [], "x"
    for n, made in enumerate([*activations, []], start=1):
        nodes += [node("MatMul", f"{value} w{n}", f"a{n}"), node("Add", f"a{n} b{n}", f"q{n}")]
        value = f"q{n}"
        for k, (kind, more, attributes) in enumerate(made):
            nodes.append(node(kind, f"{value} {more}", f"r{n}{k}", **attributes))
            value = f"r{n}{k}"
    nodes[-1].output[0] = "y"
    return nodes


def numbers() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    found = {
        "gain": rng.uniform(0.5, 2, 4),
        "offset": rng.normal(0, 1, 4),
        "mean": rng.normal(0, 1, 4),
        "variance": rng.uniform(0.5, 2, 4),
        "slope": np.array([0.3]),
        "one": np.array(1.0),
        "minus_one": np.array(-1.0),
    }
    for n, (inputs, outputs) in enumerate(pairwise((3, 4, 5, 2)), start=1):
        found[f"w{n}"] = rng.normal(0, 1, (inputs, outputs))
        found[f"b{n}"] = rng.normal(0, 1, outputs)
    return found


NORMALISED = ("BatchNormalization", "gain offset mean variance", {"epsilon": 1e-3})
UNDERSTOOD = {
    "relu": (("Relu", "", {}),),
    "sigmoid": (("Sigmoid", "", {}),),
    "tanh": (("Tanh", "", {}),),
    "leaky": (("LeakyRelu", "", {"alpha": 0.2}),),
    "leaky as PyTorch has it": (("LeakyRelu", "", {}),),
    "one slope": (("PRelu", "slope", {}),),
    "clipped": (("Clip", "minus_one one", {}),),
    "nothing": (),
    "normalised before": (NORMALISED, ("Relu", "", {})),
    "normalised behind": (("Relu", "", {}), NORMALISED),
    "flattened": (("Flatten", "", {}), ("Relu", "", {})),
}


@pytest.mark.parametrize("name", UNDERSTOOD)
def test_a_graph_computes_what_onnx_says(tmp_path: Path, name: str) -> None:
    path = graph(tmp_path, chain(UNDERSTOOD[name], [("Relu", "", {})]), numbers())
    x = np.random.default_rng(2).normal(0, 2, (50, 3))
    (expected,) = ReferenceEvaluator(str(path)).run(None, {"x": x})
    found = load_network(path, (3, 0, 2))
    assert found.shape == (3, 4, 5, 2)
    assert np.abs(found.process(x) - expected).max() < 1e-6


# On the engine.


@st.composite
def networks(draw: st.DrawFn) -> Trained:
    """Networks of one to four hidden layers, with a node that nothing uses."""
    kinds = draw(st.lists(st.sampled_from(list(ACTIVATIONS)), min_size=1, max_size=4))
    shape = draw(st.lists(st.integers(1, 5), min_size=len(kinds) + 2, max_size=len(kinds) + 2))
    spread = draw(st.sampled_from([0.1, 1.0, 10.0]))
    return random(tuple(shape), tuple(kinds), draw(st.integers(0, 99)), spread)


@settings(max_examples=40)
@given(network=networks())
def test_the_engine_is_as_near_to_real_arithmetic_as_its_formats(network: Trained) -> None:
    codes = random_codes(network.shape[0], 40)
    real = network.process(SIGNAL.to_real(codes))
    wanted = np.clip(real, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))
    found = {}
    for lean in (True, False):
        try:
            engine = Engine.of([network], Settings(lean=lean))
        except InputError as error:
            # Sums of five layers of large weights may grow beyond what a program holds.
            if "products of 18 bits" not in str(error):
                raise
            reject()
        found[lean] = engine.process(codes)
        assert np.array_equal(found[lean], exact(engine, codes))
    assert np.array_equal(found[True], found[False])
    off = np.abs(SIGNAL.to_real(found[True]) - wanted)
    assert (off <= engine_bounds(network, 9, network.shape[0])).all()


@pytest.mark.parametrize(
    ("place", "layer", "size"), [("weights", 0, 1e9), ("biases", 0, 1e9), ("weights", 1, 1e9)]
)
@pytest.mark.parametrize("activation", ["tanh", "hard_tanh"])
def test_weights_that_no_format_holds_are_refused(activation, place, layer, size) -> None:
    layers = list(layers_of(random((3, 4, 2), (activation,))))
    getattr(layers[layer], place)[1] = size
    with pytest.raises(
        InputError, match=rf"layer {layer + 1}: node 2: got a weight or a bias that takes \d+ prod"
    ):
        Engine.of([network_of(layers)])


def test_nodes_that_no_output_uses_are_left_out_layer_by_layer() -> None:
    first, second, last = random((3, 4, 5, 2), ("relu", "relu")).layers
    # The last node of layer 2 alone uses the first of layer 1.
    second.weights[:-1, 0] = 0
    last.weights[:, -1] = 0
    engine = Engine.of([network_of([first, second, last])])
    names = [neuron.name for neuron in engine.graph.neurons]
    assert engine.useless_nodes == 3
    assert names == [
        *(f"layer 1 node {n}" for n in (2, 3)),
        *(f"layer 2 node {n}" for n in (1, 2, 3, 4)),
        "output 1",
        "output 2",
    ]


# In scenes.


def scene_of(tmp_path: Path, network: Trained, design: str = "engine") -> Path:
    return write_scene(tmp_path, "several", "exact", [network], activation="precise", design=design)


def test_a_scene_may_name_activations_or_leave_them_to_the_file(tmp_path: Path) -> None:
    path = scene_of(tmp_path, random((3, 4, 5, 2), ("relu", "sigmoid")))
    text = path.read_text()
    for hidden in ("[4, 5]", "0", '[4, 5]\nactivations = ["relu", "sigmoid"]'):
        path.write_text(text.replace("hidden = [4, 5]", f"hidden = {hidden}"))
        assert load_scene(str(path)).describe() == "3:4:5:2"
