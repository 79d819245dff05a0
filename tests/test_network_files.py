"""Tests network files of other programs, and what is refused with its name."""

from pathlib import Path

import numpy as np
import onnx
import pytest
from conftest import recorded_of
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator
from scipy.io import savemat

from golden.networks.engine import Engine
from golden.numbers.precision import SIGNAL
from golden.trained.mlp import Mlp
from tactus.cli.network import main as convert
from tactus.network_files.network_file import load_network, write_network
from tactus.network_files.onnx import EXPRESSIONS
from tactus.scene import Scene, load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

SHAPE = (3, 5, 2)
DATA = Path(__file__).parent / "data"
FORMS = [".npz", ".mat", ".onnx"]


def same(one: Mlp, other: Mlp) -> bool:
    names = ("w1", "b1", "w2", "b2")
    return all(np.array_equal(getattr(one, n), getattr(other, n)) for n in names)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("shape", [SHAPE, (1, 1, 1)])
def test_every_form_gives_the_same_network_back(tmp_path: Path, form: str, shape) -> None:
    mlp = random_mlp(shape, 1.0, 1)
    write_network(tmp_path / f"net{form}", mlp)
    assert same(load_network(tmp_path / f"net{form}", shape), mlp)
    assert [p.name for p in tmp_path.iterdir()] == [f"net{form}"]


def test_our_onnx_computes_what_our_float_network_computes(tmp_path: Path) -> None:
    mlp = random_mlp(SHAPE, 1.0, 1)
    write_network(tmp_path / "net.onnx", mlp)
    frames = np.random.default_rng(1).uniform(-1, 1, (20, 3))
    (results,) = ReferenceEvaluator(str(tmp_path / "net.onnx")).run(None, {"x": frames})
    assert np.allclose(results, mlp.process(frames), atol=1e-14)


SCALED_FILES = ["sklearn-scaled-3-5-2", "sklearn-scaled-double-3-5-2", "sklearn-target-3-5-1"]


@pytest.mark.parametrize("name", ["sklearn-3-5-1", "sklearn-3-5-2", *SCALED_FILES])
def test_a_network_from_scikit_learn(name: str) -> None:
    """skl2onnx writes Cast, MatMul, Add, Tanh, MatMul, Add, Reshape.

    A StandardScaler is a Scaler, or Sub and Div; the target may be scaled (make_onnx.py).
    """
    outputs = int(name[-1])
    mlp = load_network(DATA / f"{name}.onnx", (3, 5, outputs))
    recorded = recorded_of(name)
    expected = recorded["y"].reshape(-1, outputs)
    # scikit-learn predicts in double precision, but float32 has only 24 bits.
    assert np.allclose(mlp.process(recorded["x"]), expected, rtol=1e-6, atol=1e-6)


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
    bound = lsb * (np.abs(mlp.w2) @ (np.abs(mlp.w1).sum(axis=1) + 1) + 1)
    factors = [s.factor for s in scene.scales(scene.outputs)]
    assert (np.abs(results - expected) < bound * factors).all()
    assert (bound < 0.02).all()


@pytest.mark.parametrize("name", ["torch", "torch-legacy", "keras"])
def test_a_network_from_pytorch_and_keras(name: str) -> None:
    """The frameworks wrote these files themselves, each with eight inputs and its outputs.

    torch 2.15, ``net = Sequential(Linear(4, 16), Tanh(), Linear(16, 4))``:
    ``torch.onnx.export(net, (x,), "torch-4-16-4.onnx", dynamo=True)``, ``False`` for legacy;
    stack traces, which name folders of the machine, are taken out of the nodes' metadata.
    keras 3.15 with tensorflow 2.21 and tf2onnx 1.17,
    ``net = Sequential([Input((4,)), Dense(16, activation="tanh"), Dense(4)])``, random biases:
    ``net.export("keras-4-16-4.onnx", format="onnx")``.
    """
    mlp = load_network(DATA / f"{name}-4-16-4.onnx", (4, 16, 4))
    recorded = recorded_of(f"{name}-4-16-4")
    assert np.abs(mlp.process(recorded["x"]) - recorded["y"]).max() < 1e-6
    assert np.abs(mlp.b1).min() > 0
    assert np.abs(mlp.b2).min() > 0


def graph(tmp_path: Path, nodes, constants) -> Path:
    made = helper.make_graph(
        nodes,
        "test",
        [helper.make_tensor_value_info("x", TensorProto.DOUBLE, [None, 3])],
        [helper.make_tensor_value_info("y", TensorProto.DOUBLE, [None, 2])],
        [numpy_helper.from_array(np.asarray(v), k) for k, v in constants.items()],
    )
    path = tmp_path / "net.onnx"
    onnx.save(helper.make_model(made), str(path))
    return path


def constants(mlp: Mlp) -> dict[str, np.ndarray]:
    return {"w1": mlp.w1.T, "b1": mlp.b1, "w2": mlp.w2.T, "b2": mlp.b2}


def node(kind: str, inputs: str, output: str, **attributes):
    return helper.make_node(kind, inputs.split(), [output], name=f"my_{kind}", **attributes)


def scaler(inputs: str, output: str, **attributes):
    return node("Scaler", inputs, output, domain="ai.onnx.ml", **attributes)


KERAS = [
    node("MatMul", "x w1", "a"),
    node("Add", "a b1", "b"),
    node("Tanh", "b", "c"),
    node("MatMul", "c w2", "d"),
    node("Add", "b2 d", "y"),
]


def test_matmul_and_add_as_keras_writes_them(tmp_path: Path) -> None:
    """Layers without a bias get zeros."""
    mlp = random_mlp(SHAPE, 1.0, 1)
    assert same(load_network(graph(tmp_path, KERAS, constants(mlp)), SHAPE), mlp)
    nodes = [node("MatMul", "x w1", "a"), node("Tanh", "a", "b"), node("MatMul", "b w2", "y")]
    found = load_network(graph(tmp_path, nodes, constants(mlp)), SHAPE)
    assert not found.b1.any()
    assert not found.b2.any()


def test_gemm_scales_as_it_says(tmp_path: Path) -> None:
    mlp = random_mlp(SHAPE, 1.0, 1)
    first = node("Gemm", "x w1 b1", "a", alpha=0.5, beta=2.0)
    nodes = [first, node("Tanh", "a", "b"), node("Gemm", "b w2 b2", "y")]
    found = load_network(graph(tmp_path, nodes, constants(mlp)), SHAPE)
    assert np.allclose(found.w1, mlp.w1 / 2)
    assert np.allclose(found.b1, mlp.b1 * 2)


SCALED = {
    "factor": np.array([0.5, 2.0, 3.0]),
    "mean": np.array([[1.0, -2.0, 4.0]]),
    "half": 0.5,
    "wide": np.arange(1.0, 6.0),
    "ends": np.array([10.0, -0.1]),
}
BEFORE = [
    [node("Sub", "x mean", "s"), node("Div", "s factor", "t")],
    [scaler("x", "s", offset=[1.0, -2.0, 4.0], scale=[2.0, 0.5, 0.1]), node("Sub", "half s", "t")],
    [node("Mul", "factor x", "s"), node("Add", "s half", "r"), node("Sub", "r mean", "t")],
    [scaler("x", "t", offset=[0.25], scale=[4.0])],
]


@pytest.mark.parametrize("before", BEFORE)
def test_what_scales_value_by_value_is_folded(tmp_path: Path, before: list) -> None:
    """It may come before the first layer, after it, after tanh, or after the last layer."""
    mlp = random_mlp(SHAPE, 1.0, 1)
    nodes = [
        *before,
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
    path = graph(tmp_path, nodes, constants(mlp) | SCALED)
    model = onnx.load(str(path))
    model.opset_import.append(helper.make_opsetid("ai.onnx.ml", 3))
    onnx.save(model, str(path))
    x = np.random.default_rng(1).uniform(-5, 5, (20, 3))
    (expected,) = ReferenceEvaluator(str(path)).run(None, {"x": x})
    assert np.allclose(load_network(path, SHAPE).process(x), expected, atol=1e-5)


OPERATORS = [
    *(node(kind, "b", "c") for kind in EXPRESSIONS),
    node("Gelu", "b", "c", approximate="tanh"),
    node("Elu", "b", "c", alpha=0.5),
    node("Celu", "b", "c", alpha=2.0),
    node("Selu", "b", "c", alpha=1.5, gamma=-0.5),
    node("HardSigmoid", "b", "c", alpha=0.25, beta=0.375),
]


@pytest.mark.parametrize(
    "operator", OPERATORS, ids=lambda n: f"{n.op_type}{[a.name for a in n.attribute]}"
)
def test_an_operator_that_becomes_a_table(tmp_path: Path, operator) -> None:
    """No sum leaves the range of a table here, so that the network is that of the file."""
    mlp = random_mlp(SHAPE, 0.5, 1)
    path = graph(tmp_path, [*KERAS[:2], operator, *KERAS[3:]], constants(mlp))
    x = np.random.default_rng(1).uniform(-1, 1, (20, 3))
    # The reference computes Celu and others in the precision of their input.
    (expected,) = ReferenceEvaluator(str(path)).run(None, {"x": x})
    network = load_network(path, SHAPE)
    assert network.activations == (f"table:{operator.op_type.lower()}",)
    assert np.abs(x @ mlp.w1.T + mlp.b1).max() < 8
    assert np.allclose(network.process(x), expected, atol=1e-6)
    # The engine has it as a table.
    codes = SIGNAL.quantise(x)[0]
    found = Engine.of([network]).process(codes)
    assert np.abs(SIGNAL.to_real(found) - np.clip(expected, -1, 1)).max() < 2e-3


def test_an_operator_with_two_kinds_of_attributes_is_two_functions(tmp_path: Path) -> None:
    mlp = random_mlp(SHAPE, 0.5, 1)
    nodes = [
        *KERAS[:2],
        node("Elu", "b", "c", alpha=0.5),
        node("MatMul", "c w3", "e"),
        node("Elu", "e", "f", alpha=2.0),
        node("MatMul", "f w2", "y"),
    ]
    path = graph(tmp_path, nodes, constants(mlp) | {"w3": np.eye(5) - 0.5})
    network = load_network(path, (3, 0, 2))
    assert network.activations == ("table:elu", "table:elu_2")
    x = np.random.default_rng(1).uniform(-1, 1, (20, 3))
    (expected,) = ReferenceEvaluator(str(path)).run(None, {"x": x})
    assert np.allclose(network.process(x), expected, atol=1e-6)


def test_netlab_structures_of_any_name(tmp_path: Path) -> None:
    mlp = random_mlp(SHAPE, 1.0, 1)
    fields = {"w1": mlp.w1.T, "b1": mlp.b1[None], "w2": mlp.w2.T, "b2": mlp.b2[None]}
    path = tmp_path / "net.mat"
    savemat(path, {"demonetwork": fields | {"nin": 3}, "note": "trained long ago"})
    assert same(load_network(path, SHAPE), mlp)
    savemat(path, fields)
    assert same(load_network(path, SHAPE), mlp)


@pytest.mark.parametrize("form", FORMS)
def test_a_scene_can_name_any_form(small_scene: Scene, monkeypatch, form: str) -> None:
    file = small_scene.path.with_name(f"other{form}")
    monkeypatch.setattr("sys.argv", ["convert", str(small_scene.path), str(file)])
    convert()
    small_scene.path.write_text(small_scene.path.read_text().replace("small.npz", file.name))
    assert load_scene(str(small_scene.path)).twin() == small_scene.twin()
