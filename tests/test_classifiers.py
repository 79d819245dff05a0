"""Tests networks of classifiers: what is read of their end, and what is refused in it."""

from pathlib import Path

import numpy as np
import onnx
import pytest
from conftest import recorded_of
from onnx import TensorProto, helper, numpy_helper

from golden.input_error import InputError
from golden.trained.dense import Quantiser
from tactus.core.finding import OK
from tactus.network_files.network_file import held_in, load_network, write_network
from tactus.network_files.parsed import Ending, ParsedLayer, ParsedNetwork, for_labels
from tactus.rig.check import networks_there
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

DATA = Path(__file__).parent / "data"
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


def node(kind: str, taken: str, given: str, **attributes):
    return helper.make_node(kind, taken.split(), given.split(), f"my_{kind}", **attributes)


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
    found, expected = load_network(path, (3, 5, width)), NETWORKS[width]
    assert all(np.array_equal(getattr(found, n), getattr(expected, n)) for n in ("w2", "b2"))
    assert held_in(path).ending == ending


def test_a_sigmoid_alone_is_the_probability_that_it_was(tmp_path: Path) -> None:
    path = classifier(tmp_path, [node("Sigmoid", "v", "p")], "p", 1)
    assert load_network(path, (3, 0, 1)).activations == ("tanh", "sigmoid")
    assert held_in(path).ending is None


def test_an_output_that_nothing_gives_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"operator Softmax .*: gives no output 'q' of the graph"):
        load_network(classifier(tmp_path, [SOFTMAX], "p q"), (3, 0, 2))


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
