"""Tests network files of other programs, and what is refused with its name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import onnx
import pytest
from conftest import recorded_of
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator
from refused import call
from scipy.io import savemat
from test_engine import random_codes

from golden.input_error import InputError, MissingFileError
from golden.networks.engine import Engine
from golden.networks.oracle import engine_bounds
from golden.numbers.precision import SIGNAL
from golden.trained.dense import ACTIVATIONS, DenseNetwork, Quantiser, network_of
from tactus.core.finding import OK
from tactus.network_files.network_file import (
    check_targets,
    held_in,
    load_network,
    read_provenance,
    save_network,
    save_networks,
    write_network,
)
from tactus.network_files.onnx import EXPRESSIONS
from tactus.network_files.parsed import Ending, ParsedLayer, ParsedNetwork, for_labels
from tactus.rig.check import networks_there
from tactus.scene import Scene, load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp, random_network

SHAPE = (3, 5, 2)
DATA = Path(__file__).parent / "data"
FORMS = [".npz", ".mat", ".onnx"]
QONNX = "qonnx.custom_op.general"


def same(one: DenseNetwork, other: DenseNetwork) -> bool:
    return all(
        np.array_equal(a.weights, b.weights)
        and np.array_equal(a.biases, b.biases)
        and (a.activation_text, a.leak) == (b.activation_text, b.leak)
        for a, b in zip(one.layers, other.layers, strict=True)
    )


TANH = ("tanh",)
ROUND_TRIPS = [
    *((form, shape, TANH) for form in FORMS for shape in (SHAPE, (1, 1, 1))),
    *((form, (3, 4, 5, 2), ("relu", "tanh")) for form in FORMS if form != ".mat"),
    *((form, (2, 3, 1), ("sigmoid",)) for form in FORMS if form != ".mat"),
    *((f, (3, 2, 4, 3, 2), ("leaky_relu", "hard_tanh", "linear")) for f in FORMS if f != ".mat"),
]


@pytest.mark.parametrize(("form", "shape", "kinds"), ROUND_TRIPS)
def test_a_file_gives_the_same_network_back(tmp_path: Path, form: str, shape, kinds) -> None:
    """ONNX's own reference implementation computes what the network in floating point does."""
    network, path = random_network(shape, kinds, 1.0, 1), tmp_path / f"net{form}"
    if kinds[0] == "leaky_relu":
        first, *others = network.layers
        network = network_of([replace(first, leak=0.25), *others])
    write_network(path, network)
    for asked in (shape, (shape[0], 0, shape[-1])):
        assert same(load_network(path, asked), network)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    if form == ".onnx":
        x = np.random.default_rng(1).uniform(-1, 1, (20, shape[0]))
        (results,) = ReferenceEvaluator(str(path)).run(None, {"x": x})
        assert np.allclose(results, network.process(x), atol=1e-14)


def test_arrays_of_an_npz_that_do_not_go_together(tmp_path: Path) -> None:
    arrays = {
        f"{name}{n}": np.ones((2, 2)[: 2 - (name == "b")]) for name in "wb" for n in (1, 2, 3)
    }
    two = np.array(["relu", "leaky_relu"])
    for more, message in (
        ({}, "got an array 'w3' and 1 activations, expected an activation for each layer but"),
        ({"activations": np.array([1, 2])}, "activations: got int64 of shape"),
        ({"activations": np.array(["relu", "rellu"])}, "layer 2: activation: got 'rellu', exp"),
        ({"activations": two, "leaks": np.array([0.1])}, "leaks: got 1 numbers, expected 2"),
        ({"activations": two, "leaks": np.array([9, 9])}, "layer 2: leak: got 9.0, expected 0 to"),
        ({"activations": np.array(["relu"] * 3)}, "no array 'w4', got w1"),
    ):
        np.savez(tmp_path / "net.npz", **arrays, **more)
        with pytest.raises(InputError, match=f"net.npz: {message}"):
            load_network(tmp_path / "net.npz", (2, 0, 2))


def test_networks_of_one_file_are_written_anew_one_by_one_or_not_at_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    x, y, other = (random_mlp(SHAPE, 1.0, n) for n in range(3))
    file, there = tmp_path / "net.npz", tmp_path / "net.npz" / "x"
    save_networks([(there, x, {"seed": 1}), (file / "load [N/m]", y, {"seed": 2})])
    save_network(there, other, {"seed": 3})
    assert same(load_network(there, SHAPE), other)
    assert same(load_network(file / "load [N/m]", SHAPE), y)
    assert [read_provenance(file / name)["seed"] for name in ("x", "load [N/m]")] == [3, 2]
    with pytest.raises(MissingFileError, match=r"net.npz/z: no such network, got x/w1, "):
        load_network(file / "z", SHAPE)
    assert read_provenance(file / "z") is None
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    original = Path.replace

    def interrupted(one: Path, target: Path) -> Path:
        monkeypatch.undo()
        original(one, target)
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save_network(there, x, {"seed": 4})
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    file.write_bytes(b"")
    with pytest.raises(InputError, match=r"net.npz: not an NPZ of numbers"):
        check_targets([there])


SCALED_FILES = ["sklearn-scaled-3-5-2", "sklearn-scaled-double-3-5-2", "sklearn-target-3-5-1"]
FRAMEWORKS = ["torch-4-16-4", "torch-legacy-4-16-4", "keras-4-16-4"]


@pytest.mark.parametrize("name", ["sklearn-3-5-1", "sklearn-3-5-2", *SCALED_FILES, *FRAMEWORKS])
def test_a_network_from_a_framework(name: str) -> None:
    """The frameworks wrote these files themselves, each with eight inputs and its outputs.

    skl2onnx (make_onnx.py) writes Cast, MatMul, Add, Tanh, MatMul, Add, Reshape. A StandardScaler
    is a Scaler, or Sub and Div; the target may be scaled.
    torch 2.15, ``net = Sequential(Linear(4, 16), Tanh(), Linear(16, 4))``:
    ``torch.onnx.export(net, (x,), "torch-4-16-4.onnx", dynamo=True)``, ``False`` for legacy;
    stack traces, which name folders of the machine, are taken out of the nodes' metadata.
    keras 3.15 with tensorflow 2.21 and tf2onnx 1.17,
    ``net = Sequential([Input((4,)), Dense(16, activation="tanh"), Dense(4)])``, random biases:
    ``net.export("keras-4-16-4.onnx", format="onnx")``.
    """
    shape = (4, 16, 4) if name in FRAMEWORKS else (3, 5, int(name[-1]))
    mlp, recorded = load_network(DATA / f"{name}.onnx", shape), recorded_of(name)
    expected = recorded["y"].reshape(-1, shape[-1])
    # scikit-learn predicts in double precision, but float32 has only 24 bits.
    assert np.allclose(mlp.process(recorded["x"]), expected, rtol=1e-6, atol=1e-6)
    assert all(layer.biases.all() for layer in mlp.layers)


@pytest.mark.parametrize("name", SCALED_FILES)
def test_such_a_pipeline_in_raw_units_becomes_hardware(tmp_path: Path, name: str) -> None:
    outputs = int(name[-1])
    path = write_scene(tmp_path, "raw", "exact", [random_mlp((3, 5, outputs), 1.0, 1)])
    recorded = recorded_of(name)
    x, expected = recorded["x"], recorded["y"].reshape(-1, outputs)
    rows = ["x0,x1,x2,y0,y1"[: 8 + 3 * outputs]]
    rows += [",".join(map(repr, row.tolist())) for row in np.hstack([x, expected])]
    path.with_suffix(".csv").write_text("\n".join(rows))
    scale = "scale = { x0 = { offset = 2.5, factor = 2.5 }, x1 = { offset = -300, factor = 128 }, "
    scale += f"x2 = {{ factor = 0.05 }}, y0 = {{ factor = {20 if 'target' in name else 1} }} }}"
    text = path.read_text().replace('"raw.npz"', f'"{DATA / name}.onnx"')
    path.write_text(text.replace('group_by = "y0"', scale).replace('"gradient"', '"precise"'))
    scene = load_scene(str(path))
    results = scene.outputs_in_units(scene.twin().process(scene.codes_of(x)))
    # Half an LSB of a sample changes a hidden sum by this, times its weight. tanh does not enlarge
    # it. Twice that leaves room for the rounding of weights, of tanh and of the output.
    (mlp,) = scene.mlps()
    lsb = 2.0**-SIGNAL.frac
    first, second = (np.abs(layer.weights) for layer in mlp.layers)
    bound = lsb * (second @ (first.sum(axis=1) + 1) + 1)
    factors = [s.factor for s in scene.scales(scene.outputs)]
    assert (np.abs(results - expected) < bound * factors).all()
    assert (bound < 0.02).all()


def graph(folder: Path, nodes, constants, inputs: int = 3, kind=TensorProto.DOUBLE) -> Path:
    """A file of a graph from x to y, which may use the operators of ai.onnx.ml and of QONNX."""
    x = helper.make_tensor_value_info("x", kind, [None, inputs])
    y = helper.make_tensor_value_info("y", kind, [None, None])
    tensors = [numpy_helper.from_array(np.asarray(v), k) for k, v in constants.items()]
    opsets = [("", 21), ("ai.onnx.ml", 3), (QONNX, 1)]
    model = helper.make_model(
        helper.make_graph(nodes, "test", [x], [y], tensors),
        opset_imports=[helper.make_opsetid(*one) for one in opsets],
    )
    onnx.save(model, str(folder / "net.onnx"))
    return folder / "net.onnx"


def constants(mlp: DenseNetwork) -> dict[str, np.ndarray]:
    (w1, b1), (w2, b2) = ((layer.weights.T, layer.biases) for layer in mlp.layers)
    return {"w1": w1, "b1": b1, "w2": w2, "b2": b2}


def node(kind: str, inputs: str, outputs: str, **attributes):
    return helper.make_node(kind, inputs.split(), outputs.split(), f"my_{kind}", **attributes)


def scaler(inputs: str, output: str, **attributes):
    return node("Scaler", inputs, output, domain="ai.onnx.ml", **attributes)


KERAS = [
    node("MatMul", "x w1", "a"),
    node("Add", "a b1", "b"),
    node("Tanh", "b", "c"),
    node("MatMul", "c w2", "d"),
    node("Add", "b2 d", "y"),
]


def test_weights_are_taken_as_they_are(tmp_path: Path) -> None:
    """As Keras writes them, and where operators make them of other constants."""
    mlp = random_mlp(SHAPE, 1.0, 1)
    assert same(load_network(graph(tmp_path, KERAS, constants(mlp)), SHAPE), mlp)
    weights = mlp.layers[0].weights.T
    held = constants(mlp) | {"w1": -weights[:2], "more": -weights[2:]}
    made = [node("Concat", "w1 more", "all", axis=0), node("Neg", "all", "negative")]
    nodes = [*made, node("MatMul", "x negative", "a"), *KERAS[1:]]
    assert same(load_network(graph(tmp_path, nodes, held), SHAPE), mlp)


BESIDE = {
    "factor": np.array([0.5, 2.0, 3.0]),
    "mean": np.array([[1.0, -2.0, 4.0]]),
    "half": 0.5,
    "wide": np.arange(1.0, 6.0),
    "some": np.array([0.5, -1.0, 0.1, 0.7, 2.0]),
    "ends": np.array([10.0, -0.1]),
    "slope": np.array([0.3]),
    "one": np.array(1.0),
    "minus_one": np.array(-1.0),
    "w3": np.eye(5) - 0.5,
}
BEFORE = [
    [node("Sub", "x mean", "s"), node("Div", "s factor", "t")],
    [scaler("x", "s", offset=[1.0, -2.0, 4.0], scale=[2.0, 0.5, 0.1]), node("Sub", "half s", "t")],
    [node("Mul", "factor x", "s"), node("Add", "s half", "r"), node("Sub", "r mean", "t")],
    [scaler("x", "t", offset=[0.25], scale=[4.0])],
]
# What scales value by value before the first layer, after it, after tanh, and after the last layer.
SCALED = [
    node("MatMul", "t w1", "a"),
    node("Add", "a b1", "a1"),
    node("Mul", "a1 half", "b"),
    node("Tanh", "b", "c"),
    node("Div", "c wide", "c1"),
    node("Add", "c1 wide", "c2"),
    node("MatMul", "c2 w2", "d"),
    node("Add", "d b2", "d1"),
    node("Mul", "d1 ends", "d2"),
    node("Sub", "ends d2", "y"),
]


def behind(*nodes) -> list:
    """These operators, from b to c, behind the first layer of a network as Keras writes it."""
    return [*KERAS[:2], *nodes, *KERAS[3:]]


def normalised(taken: str, given: str):
    inputs = f"{taken} wide some some wide"
    return node("BatchNormalization", inputs, given, epsilon=1e-3)


TWO = [node("Elu", "b", "e", alpha=0.5), node("MatMul", "e w3", "f"), node("Elu", "f", "c")]
ALONE = [node("MatMul", "x w1", "a"), node("Tanh", "a", "b"), node("MatMul", "b w2", "y")]
GEMM = [node("Gemm", "x w1 b1", "a", alpha=0.5, beta=2.0), node("Tanh", "a", "b")]
# The nodes of a graph, and the activations of its network.
GRAPHS = [
    *(([*before, *SCALED], ("tanh",)) for before in BEFORE),
    (ALONE, ("tanh",)),
    ([*GEMM, node("Gemm", "b w2 b2", "y")], ("tanh",)),
    (behind(*TWO), ("table:elu", "table:elu_2")),
    (behind(node("Relu", "b", "c")), ("relu",)),
    (behind(node("Sigmoid", "b", "c")), ("sigmoid",)),
    (behind(node("LeakyRelu", "b", "c", alpha=0.2)), ("leaky_relu",)),
    (behind(node("LeakyRelu", "b", "c")), ("leaky_relu",)),
    (behind(node("PRelu", "b slope", "c")), ("leaky_relu",)),
    (behind(node("Clip", "b minus_one one", "c")), ("hard_tanh",)),
    (behind(node("Identity", "b", "c")), ("linear",)),
    (behind(normalised("b", "n"), node("Relu", "n", "c")), ("relu",)),
    (behind(node("Relu", "b", "n"), normalised("n", "c")), ("relu",)),
    (behind(node("Flatten", "b", "n"), node("Relu", "n", "c")), ("relu",)),
]
TABLES = [
    *(node(kind, "b", "c") for kind in EXPRESSIONS),
    node("Gelu", "b", "c", approximate="tanh"),
    node("Elu", "b", "c", alpha=0.5),
    node("Celu", "b", "c", alpha=2.0),
    node("Selu", "b", "c", alpha=1.5, gamma=-0.5),
    node("HardSigmoid", "b", "c", alpha=0.25, beta=0.375),
]
GRAPHS += [(behind(one), (f"table:{one.op_type.lower()}",)) for one in TABLES]


@pytest.mark.parametrize(("nodes", "activations"), GRAPHS)
def test_a_graph_computes_what_onnx_says(tmp_path: Path, nodes: list, activations) -> None:
    """No sum leaves the range of a table here, so that the network is that of the file."""
    mlp = random_mlp(SHAPE, 0.5, 1)
    path = graph(tmp_path, nodes, BESIDE | constants(mlp))
    x = np.random.default_rng(1).uniform(-1, 1, (20, 3))
    # The reference computes Celu and others in the precision of their input.
    (expected,) = ReferenceEvaluator(str(path)).run(None, {"x": x})
    network = load_network(path, (3, 0, 2))
    assert network.activations == activations
    assert np.allclose(network.process(x), expected, atol=1e-5)
    if activations[0].startswith("table"):
        assert np.abs(mlp.layers[0].sums(x)).max() < 8
        found = Engine.of([network]).process(SIGNAL.quantise(x)[0])
        assert np.abs(SIGNAL.to_real(found) - np.clip(expected, -1, 1)).max() < 2e-3


def test_netlab_structures_of_any_name(tmp_path: Path) -> None:
    mlp = random_mlp(SHAPE, 1.0, 1)
    fields = {name: np.atleast_2d(array) for name, array in constants(mlp).items()}
    path = tmp_path / "net.mat"
    savemat(path, {"demonetwork": fields | {"nin": 3}, "note": "trained long ago"})
    assert same(load_network(path, SHAPE), mlp)
    savemat(path, fields)
    assert same(load_network(path, SHAPE), mlp)


@pytest.mark.parametrize("form", FORMS)
def test_a_scene_can_name_any_form(small_scene: Scene, form: str) -> None:
    file = small_scene.path.with_name(f"other{form}")
    call("network", small_scene.path, file)
    small_scene.path.write_text(small_scene.path.read_text().replace("small.npz", file.name))
    assert load_scene(str(small_scene.path)).twin() == small_scene.twin()


THREE = ("rest", "swipe", "tap")
FILES = {
    "sklearn-classes": ((3, 6, 4, 3), Ending("Softmax", THREE)),
    "sklearn-classes-plain": ((3, 5, 3), Ending("Softmax", (0, 10, 20))),
    "sklearn-classes-columns": ((3, 5, 3), Ending("Softmax", THREE)),
    "sklearn-two-classes": ((3, 5, 1), Ending("Sigmoid", ("none", "touch"))),
    "sklearn-two-classes-plain": ((3, 5, 1), Ending("Sigmoid", (0, 1))),
}


@pytest.mark.parametrize("name", FILES)
def test_a_classifier_from_scikit_learn(name: str) -> None:
    """A pipeline of a StandardScaler and an MLPClassifier, with and without ZipMap."""
    shape, ending = FILES[name]
    path = DATA / f"{name}.onnx"
    assert held_in(path).ending == ending
    network = load_network(path, (3, 0, shape[-1]))
    assert network.shape == shape
    recorded = recorded_of(name)
    values, expected = network.process(recorded["x"]), recorded["labels"].tolist()
    places = values.argmax(axis=1) if shape[-1] > 1 else (values[:, 0] > 0).astype(int)
    assert [ending.labels[place] for place in places] == expected
    assert len(set(expected)) == max(shape[-1], 2)


def test_make_check_tells_where_a_classifier_ends(tmp_path: Path) -> None:
    network = random_mlp((3, 5, 1), 1.0, 1)
    for name, said in (
        ("sklearn-two-classes-plain", "a 3:5:1 network that ends in front of Sigmoid; its classes"),
        ("sklearn-3-5-1", "a 3:5:1 network"),
    ):
        path = write_scene(tmp_path, "classes", "exact", [network])
        text = path.read_text().replace('"classes.npz"', f'"{DATA / name}.onnx"')
        path.write_text(text)
        (found,) = networks_there(load_scene(str(path)))
        assert (found.verdict, found.text[: len(said)]) == (OK, said)
        assert found.text.endswith("are 0, 1") == ("classes" in name)


NETWORKS = {width: random_mlp((3, 5, width), 1.0, 1) for width in (1, 2)}
CONSTANTS = {"one": 1.0, "names": np.array(["up", "down"]), "sizes": np.array(["10", "9"])}


def classifier(tmp_path: Path, tail: list, outputs: str, width: int = 2) -> Path:
    """A network of Gemm, Tanh and Gemm, whose values are ``v``, with ``tail`` behind it."""
    path = tmp_path / "net.onnx"
    write_network(path, NETWORKS[width])
    graph = onnx.load(str(path)).graph
    graph.node[-1].output[0] = "v"
    graph.node.extend(tail)
    tensors = [numpy_helper.from_array(np.asarray(v), k) for k, v in CONSTANTS.items()]
    ends = [helper.make_tensor_value_info(o, TensorProto.DOUBLE, None) for o in outputs.split()]
    made = helper.make_graph(
        graph.node, "test", list(graph.input), ends, [*graph.initializer, *tensors]
    )
    onnx.save(helper.make_model(made), str(path))
    return path


SOFTMAX = node("Softmax", "v", "p")
ARGMAX = node("ArgMax", "p", "k", axis=1)
TWO = [node("Sigmoid", "v", "b"), node("Sub", "one b", "a"), node("Concat", "a b", "p", axis=1)]
ENDS = {
    "softmax": ([SOFTMAX], "p", 2, Ending("Softmax")),
    "the logarithm": ([node("LogSoftmax", "v", "p", axis=-1)], "p", 2, Ending("LogSoftmax")),
    "the number of the class": (
        [node("ArgMax", "v", "k", axis=1, keepdims=0)],
        "k",
        2,
        Ending("ArgMax"),
    ),
    "both": ([SOFTMAX, ARGMAX, node("Squeeze", "k", "y")], "p y", 2, Ending("Softmax")),
    "labels": (
        [SOFTMAX, ARGMAX, node("Gather", "names k", "y")],
        "y",
        2,
        Ending("Softmax", ("up", "down")),
    ),
    "labels of two": (
        [*TWO, ARGMAX, node("ArrayFeatureExtractor", "names k", "y", domain="ai.onnx.ml")],
        "y p",
        1,
        Ending("Sigmoid", ("up", "down")),
    ),
    "labels as an output": ([SOFTMAX], "p names", 2, Ending("Softmax")),
}


@pytest.mark.parametrize("name", ENDS)
def test_the_network_ends_in_front_of_what_tells_the_class(tmp_path: Path, name: str) -> None:
    tail, outputs, width, ending = ENDS[name]
    path = classifier(tmp_path, tail, outputs, width)
    assert same(load_network(path, (3, 5, width)), NETWORKS[width])
    assert held_in(path).ending == ending


def test_a_sigmoid_alone_is_the_probability_that_it_was(tmp_path: Path) -> None:
    path = classifier(tmp_path, [node("Sigmoid", "v", "p")], "p", 1)
    assert load_network(path, (3, 0, 1)).activations == ("tanh", "sigmoid")
    assert held_in(path).ending is None


def scene_of_classes(tmp_path: Path, network: Path, labels: tuple[str, ...]) -> Path:
    """A scene of three sensors and five hidden nodes, with a row for each label."""
    rows = [f"{n / 8},{-n / 8},0.25,{label}" for n, label in enumerate(labels)]
    (tmp_path / "own.csv").write_text("\n".join(["a,b,c,kind", *rows, ""]))
    scene = tmp_path / "own.toml"
    scene.write_text(
        '[data]\nfile = "own.csv"\nsensors = ["a", "b", "c"]\nclasses = "kind"\n[network]\n'
        f'arrangement = "single"\nhidden = 5\nweights = ["{network}"]\n[hardware]\n'
        'design = "engine"\nprecision = "exact"\n'
    )
    return scene


DRAWN = np.random.default_rng(1).uniform(-1, 1, (200, 3))


@pytest.mark.parametrize("labels", [("none", "touch"), ("touch", "none")])
def test_one_output_tells_two_classes_apart(tmp_path: Path, labels: tuple[str, ...]) -> None:
    """What scikit-learn writes for two classes decides as it does, whatever the labels' order."""
    path = DATA / "sklearn-two-classes.onnx"
    scene = load_scene(str(scene_of_classes(tmp_path, path, labels)))
    assert scene.labels == ("none", "touch")
    (member,) = scene.members
    recorded = recorded_of(path.stem)
    decided = member.load().process(recorded["x"]).argmax(axis=1)
    assert [scene.labels[n] for n in decided] == recorded["labels"].tolist()
    (found,) = networks_there(scene)
    assert found.text.endswith("its classes are none, touch")


def test_outputs_stand_in_the_order_of_the_labels(tmp_path: Path) -> None:
    """scikit-learn sorts texts, so 10 stands in front of 9; a scene sorts whole numbers."""
    path = classifier(tmp_path, [SOFTMAX, ARGMAX, node("Gather", "sizes k", "y")], "y")
    scene = load_scene(str(scene_of_classes(tmp_path, path, ("10", "9"))))
    assert scene.labels == ("9", "10")
    own = NETWORKS[2].process(DRAWN)
    assert np.allclose(scene.members[0].load().process(DRAWN), own[:, ::-1], atol=1e-6)


def test_numbers_of_classes_stand_for_labels_in_their_order(tmp_path: Path) -> None:
    path = DATA / "sklearn-two-classes-plain.onnx"
    scene = load_scene(str(scene_of_classes(tmp_path, path, ("up", "down"))))
    (found,) = networks_there(scene)
    assert found.text.endswith("its classes are 0, 1, which are taken for down, up in this order")


def test_a_file_of_other_classes_is_refused(tmp_path: Path) -> None:
    path = DATA / "sklearn-two-classes.onnx"
    scene = load_scene(str(scene_of_classes(tmp_path, path, ("up", "down"))))
    expected = r"\.onnx: got a network for the classes none, touch, expected down, up, the labels"
    with pytest.raises(InputError, match=expected):
        scene.networks()


@pytest.mark.parametrize(("width", "tail"), [(1, "Sigmoid"), (1, ""), (2, "Sigmoid")])
def test_a_sigmoid_at_the_end_is_left_out(tmp_path: Path, width: int, tail: str) -> None:
    """Keras ends with it, and PyTorch with the value in front of it."""
    path = tmp_path / "net.onnx"
    write_network(path, NETWORKS[width])
    if tail:
        model = onnx.load(str(path))
        graph = model.graph
        graph.node.append(node("Sigmoid", graph.node[-1].output[0], "p"))
        graph.output[0].name = "p"
        onnx.save(model, str(path))
    scene = load_scene(str(scene_of_classes(tmp_path, path, ("a", "b"))))
    network, own = scene.members[0].load(), NETWORKS[width].process(DRAWN)
    assert network.shape == (3, 5, 2)
    expected = own.argmax(axis=1) if width > 1 else (own[:, 0] > 0).astype(int)
    assert 0 < expected.sum() < len(expected)
    assert np.array_equal(network.process(DRAWN).argmax(axis=1), expected)


def test_a_quantised_sigmoid_at_the_end_decides_at_a_half() -> None:
    quantiser = Quantiser(1 / 8, 0, 0, 7)
    first = ParsedLayer(np.ones((1, 3)), np.zeros(1), "sigmoid", quantiser=quantiser)
    held = ParsedNetwork((first, ParsedLayer(np.eye(1), np.zeros(1))))
    last = for_labels(Path("net.npz"), held, ("a", "b")).layers[-1]
    assert last.weights.tolist() == [[0], [1]]
    assert last.biases.tolist() == [0.5, 0]


@st.composite
def networks(draw: st.DrawFn) -> DenseNetwork:
    """Networks of one to four hidden layers, with a node that nothing uses."""
    kinds = draw(st.lists(st.sampled_from(list(ACTIVATIONS)), min_size=1, max_size=4))
    shape = draw(st.lists(st.integers(1, 5), min_size=len(kinds) + 2, max_size=len(kinds) + 2))
    spread = draw(st.sampled_from([0.1, 1.0, 10.0]))
    return random_network(tuple(shape), tuple(kinds), spread, draw(st.integers(0, 99)))


@settings(max_examples=40)
@given(network=networks())
def test_the_engine_is_as_near_to_real_arithmetic_as_its_formats(network: DenseNetwork) -> None:
    codes = random_codes(network.shape[0], 40)
    real = network.process(SIGNAL.to_real(codes))
    wanted = np.clip(real, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))
    try:
        engine = Engine.of([network])
    except InputError as error:
        # Sums of five layers of large weights may grow beyond what a program holds.
        if "products of 18 bits" not in str(error):
            raise
        reject()
    off = np.abs(SIGNAL.to_real(engine.process(codes)) - wanted)
    assert (off <= engine_bounds(network, 9, network.shape[0])).all()


@pytest.mark.parametrize(
    ("place", "layer", "size"), [("weights", 0, 1e9), ("biases", 0, 1e9), ("weights", 1, 1e9)]
)
@pytest.mark.parametrize("activation", ["tanh", "hard_tanh"])
def test_weights_that_no_format_holds_are_refused(activation, place, layer, size) -> None:
    layers = list(random_network((3, 4, 2), (activation,), 1.0, 1).layers)
    getattr(layers[layer], place)[1] = size
    with pytest.raises(
        InputError, match=rf"layer {layer + 1}: node 2: got a weight or a bias that takes \d+ prod"
    ):
        Engine.of([network_of(layers)])


def test_nodes_that_no_output_uses_are_left_out_layer_by_layer() -> None:
    first, second, last = random_network((3, 4, 5, 2), ("relu", "relu"), 1.0, 1).layers
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


def test_a_scene_may_name_activations_or_leave_them_to_the_file(tmp_path: Path) -> None:
    network = random_network((3, 4, 5, 2), ("relu", "sigmoid"), 1.0, 1)
    path = write_scene(
        tmp_path, "several", "exact", [network], activation="precise", design="engine"
    )
    text = path.read_text()
    for hidden in ("[4, 5]", "0", '[4, 5]\nactivations = ["relu", "sigmoid"]'):
        path.write_text(text.replace("hidden = [4, 5]", f"hidden = {hidden}"))
        assert load_scene(str(path)).describe() == "3:4:5:2"
