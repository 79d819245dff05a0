"""Scenes whose network tells classes apart."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import tiered
from refused import call
from test_training import differences

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import Dense, DenseNetwork, network_of, packed, tanh, unpacked
from tactus.errors import decisions_of, held_out_or_all, held_out_rows, scene_errors
from tactus.network_files.network_file import read_provenance, write_network
from tactus.report.draw.network import network as network_plot
from tactus.report.measure.outcome import accuracy, outcome
from tactus.rig import check
from tactus.rig.readings import at_ends
from tactus.scene import class_names, load_scene
from tactus.scene.labels import decided, margins, ordered, wrong_percent
from tactus.train.objective import Objective, Rows
from tb.common.cases import random_network

# To build the network of digits-fast out of adders takes ten times as long as all others together.
QUICK = [name for name in class_names() if name != "classes/digits-fast"]
LABELS = ("fist", "flat", "wave")
CENTRES = np.array([[0.4, -0.3], [-0.4, -0.2], [0.0, 0.5]])
SCENE = """
[data]
file = "hand.csv"
sensors = ["x", "y"]
classes = "gesture"
[network]
arrangement = "single"
hidden = 4
activations = ["relu"]
weights = "hand.npz"
[hardware]
design = "engine"
precision = "exact"
[training]
restarts = 2
weight_decay = 0.01
"""


def write_hand(folder: Path, rows: int = 90, labels=LABELS, more: str = "") -> Path:
    """A scene with gestures around three centres, row by row in turn."""
    rng = np.random.default_rng(2)
    lines = ["x,y,gesture,day"]
    for row in range(rows):
        x, y = CENTRES[row % 3] + rng.normal(0, 0.12, 2)
        lines.append(f"{x:.4f},{y:.4f},{labels[row % 3]},{row // 9}")
    (folder / "hand.csv").write_text("\n".join(lines) + "\n")
    path = folder / "hand.toml"
    path.write_text(SCENE + more)
    return path


@pytest.fixture(scope="module")
def hand(tmp_path_factory) -> Path:
    """A scene with a trained network."""
    path = write_hand(tmp_path_factory.mktemp("hand"))
    call("train", path, "--workers", 1, "--build", path.parent / "build")
    return path


def test_training_keeps_the_labels_and_tells_the_wrong_decisions(hand: Path) -> None:
    found = load_scene(str(hand))
    story = read_provenance(found.weights_paths[0])
    assert found.labels == LABELS
    assert found.outputs == ("gesture fist", "gesture flat", "gesture wave")
    assert (story["classes"], tuple(story["labels"])) == ("gesture", LABELS)
    split = {"validation": "validation", "test": "test"}
    every = decisions_of(found)
    rows = held_out_rows(found)
    wrong = every.bit_true != every.actual
    assert story["test_wrong_percent"] == round(100 * wrong[rows].mean(), 4)
    assert story["every_wrong_percent"] == round(100 * wrong.mean(), 4)
    assert all(story[f"{part}_wrong_percent"] <= 10 for part in split)
    assert not any(key.endswith("rms_percent") for key in story)


def test_the_hardware_decides_as_the_network_in_floating_point(hand: Path) -> None:
    every = decisions_of(load_scene(str(hand)))
    assert every.differ == 0
    assert every.confusion.sum() == 90
    assert every.confusion.trace() == every.right
    assert every.right >= 85


def test_errors_of_classes_are_those_of_the_decisions(hand: Path) -> None:
    found = load_scene(str(hand))
    every, errors = decisions_of(found), scene_errors(found)
    for n, error in enumerate(errors["bit-true"]):
        wrong = (every.bit_true == n) != (every.actual == n)
        assert error.mean == pytest.approx(100 * wrong.mean())


def test_wrong_percent_of_rows_and_draws() -> None:
    targets = np.eye(3)[[0, 1, 2, 2]]
    outputs = np.array([[0.2, 0.1, 0], [0.3, 0.1, 0], [0, 0, 0.1], [0.5, 0.5, 0.5]])
    expected = np.array([[0, 0, 0], [100, 100, 0], [0, 0, 0], [100, 0, 100]])
    assert np.array_equal(wrong_percent(outputs, targets), expected)
    draws = np.stack([outputs, targets])
    assert np.array_equal(wrong_percent(draws, targets), [expected, np.zeros((4, 3))])


@pytest.mark.parametrize("factor", [1e-6, 0.01, 1.0, 30.0, 1e4])
def test_logits_of_any_size_keep_their_decisions(hand: Path, tmp_path: Path, factor: float) -> None:
    """A network file holds logits, and one from elsewhere may have logits of any size."""
    path = write_hand(tmp_path)
    *first, last = load_scene(str(hand)).members[0].load().layers
    scaled = Dense(last.weights * factor, last.biases * factor)
    write_network(tmp_path / "hand.npz", network_of([*first, scaled]))
    found = load_scene(str(path))
    codes = found.twin().core.process(found.vectors().codes)
    assert 0.3 * SIGNAL.high < np.abs(codes).max() < SIGNAL.high
    assert np.array_equal(decided(codes), decisions_of(load_scene(str(hand))).bit_true)


def test_predict_writes_label_and_margin(hand: Path, tmp_path: Path, capsys) -> None:
    to = tmp_path / "out.csv"
    call("predict", hand, hand.with_suffix(".csv"), to)
    with to.open() as file:
        rows = list(csv.DictReader(file))
    every = decisions_of(load_scene(str(hand)))
    assert [row["gesture_predicted"] for row in rows] == [LABELS[n] for n in every.bit_true]
    assert [int(row["margin"]) for row in rows] == every.margins.tolist()
    assert sum(int(row["outside"]) for row in rows) <= 6
    counts = np.bincount(every.bit_true)
    assert (
        f"gesture: {counts[0]} fist, {counts[1]} flat, {counts[2]} wave" in capsys.readouterr()[0]
    )


def test_a_reading_like_no_class_is_outside(hand: Path, tmp_path: Path) -> None:
    new, to = tmp_path / "new.csv", tmp_path / "out.csv"
    new.write_text("x,y\n0.4,-0.3\n0.95,0.95\n")
    call("predict", hand, new, to)
    with to.open() as file:
        assert [row["outside"] for row in csv.DictReader(file)] == ["0", "1"]


def test_a_network_for_other_labels_is_refused(hand: Path, tmp_path: Path) -> None:
    path = write_hand(tmp_path, labels=("fist", "flat", "point"))
    for file in ("hand.npz", "hand.provenance.toml"):
        (tmp_path / file).write_bytes(hand.with_name(file).read_bytes())
    with pytest.raises(
        InputError, match=r"for the labels fist, flat, wave, expected fist, flat, p"
    ):
        load_scene(str(path)).networks()


@pytest.mark.all_only
def test_a_refitted_network_tells_what_it_did_before(tmp_path: Path) -> None:
    path = write_hand(tmp_path, more="refit = true\n")
    call("train", path, "--workers", 1, "--build", tmp_path / "build")
    found = load_scene(str(path))
    assert held_out_rows(found) is None
    right = 100 - read_provenance(found.weights_paths[0])["test_wrong_percent"]
    assert f"before, {right:.1f} % were right" in accuracy(outcome(found)).note
    assert held_out_or_all(found, decisions_of(found))[1] == "all 90 rows"


@pytest.mark.parametrize(
    ("labels", "expected"),
    [
        (["b", "a", "C"], ("C", "a", "b")),
        (["10", "9", "-1"], ("-1", "9", "10")),
        (["10", "9", "x"], ("10", "9", "x")),
    ],
)
def test_texts_are_sorted_by_alphabet_and_numbers_by_value(labels, expected) -> None:
    assert ordered([*labels, *labels], "place") == expected
    with pytest.raises(InputError, match="place: got another label in each of 3 rows, expected"):
        ordered(labels, "place")


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        (["a", "a"], "got 1 labels, 'a', expected 2 to 256"),
        (["1", "01", "2", "2"], "which are one number, expected one way to write it"),
        (["1", "0.5"], "got the label '0.5', expected text or whole numbers"),
        ([str(n % 300) for n in range(301)], "got 300 labels, '0', '1', '10', ..., expected 2 to"),
        (["a", "b", "NaN", "NaN"], "got 'NaN' in 2 rows, which stands for no label, expected one"),
    ],
)
def test_labels_that_are_none(labels, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        ordered(labels, "place")


def test_without_hidden_nodes_a_linear_layer_is_trained(tmp_path: Path) -> None:
    """Gestures around three centres are told apart by straight lines."""
    path = write_hand(tmp_path)
    path.write_text(path.read_text().replace('hidden = 4\nactivations = ["relu"]\n', ""))
    call("train", path, "--workers", 1, "--build", tmp_path / "build")
    found = load_scene(str(path))
    every, story = decisions_of(found), read_provenance(found.weights_paths[0])
    assert (found.describe(), story["network"], story["hidden"]) == ("2:3", "2:3", "none")
    assert every.differ == 0
    assert every.right >= 85
    assert network_plot(found).count("no hidden nodes") == 1


def counted(tmp_path: Path, rows: list[str], more: str = "") -> str:
    """What is found in a scene with a row for each of these labels."""
    path = write_hand(tmp_path, more=more)
    lines = [f"{n / 100},{n % 7 / 10},{label},{n}" for n, label in enumerate(rows)]
    path.with_suffix(".csv").write_text("\n".join(["x,y,gesture,day", *lines]) + "\n")
    return "\n".join(map(str, check.classes(load_scene(str(path)))))


def test_what_classes_lack_is_said(tmp_path: Path) -> None:
    assert "warning" not in counted(tmp_path, [*"ab"] * 20)
    text = counted(tmp_path, [*"ab"] * 20 + ["c"])
    assert "'c' stands in a single row, which cannot both train and test" in text
    assert "no row of 'c' is held out" in text or "no row of 'c' trains" in text
    text = counted(tmp_path, ["a"] * 40 + ["b"] * 9)
    assert "who always said 'a' would be right in 82 % of the rows" in text


def test_a_class_without_a_row_that_trains_is_a_fault(tmp_path: Path) -> None:
    """With blocks of ten rows, the rows of the last class are in one of four parts."""
    texts = []
    for seed in range(8):
        keys = f"split = 'blocks'\nseed = {seed}\n"
        texts.append(counted(tmp_path, ["a", "b"] * 30 + ["c"] * 4, keys))
        found = check.before_training(load_scene(str(tmp_path / "hand.toml")), tmp_path / "build")
        assert ("fault" in texts[-1]) == any("no row of 'c' trains" in f.text for f in found)
    wrong = [text for text in texts if "fault" in text]
    assert wrong
    assert "no row of 'c' trains, expected one or more of each class" in wrong[0]
    assert any("no row of 'c' is held out: the errors say nothing" in text for text in texts)


def test_make_scene_writes_a_scene_of_classes(tmp_path: Path, capsys) -> None:
    csv_file, to = write_hand(tmp_path).with_suffix(".csv"), tmp_path / "mine.toml"
    call("scene", csv_file, "--classes", "gesture", "--to", to)
    text = capsys.readouterr()[0]
    assert re.search(r"gesture +classes +3 different labels", text)
    assert "rows: 30 of 'fist', 30 of 'flat', 30 of 'wave'" in text
    found = load_scene(str(to))
    assert (found.classes, found.labels, found.sensors[:2]) == ("gesture", LABELS, ("x", "y"))
    assert found.members[0].layers == (16,)


def test_sensors_that_end_at_the_same_reading_are_one_warning() -> None:
    within = [1.0, 2.0, 3.0, 4.0]
    columns = {
        "a": np.array([0.0] * 4 + [*within, 9.0]),
        "b": np.array([0.0] * 6 + [*within, *[16.0] * 4]),
    }
    both, upper = at_ends(columns)
    assert (both.subject, upper.subject) == ("'a', 'b'", "b")
    assert "4 to 6 readings of each are exactly 0, their least: " in both.text
    assert "4 readings are exactly 16, its largest: " in upper.text
    assert [one.subject for one in at_ends(columns, known=(0.0,))] == ["b"]


def objective(network: DenseNetwork) -> Objective:
    rng = np.random.default_rng(3)

    def rows(count: int) -> Rows:
        targets = np.eye(network.shape[-1])[rng.integers(0, network.shape[-1], count)]
        inputs = rng.normal(0, 1, (count, network.shape[0]))
        return Rows(inputs, targets, targets, labelled=True)

    return Objective(network, rows(9), rows(5), 9, tanh, 1e-3)


NETWORKS = [
    random_network((3, 4, 2), ("tanh",), 1.0, 1),
    random_network((2, 4, 3, 5), ("relu", "sigmoid"), 1.0, 9),
]


@pytest.mark.parametrize("network", NETWORKS, ids=lambda n: "-".join(map(str, n.shape)))
def test_gradient_and_curvature_are_those_of_the_cross_entropy_by_the_logits(
    network: DenseNetwork,
) -> None:
    aim, point = objective(network), packed(network)
    _, gradient = aim.evaluate(point)
    assert np.allclose(gradient, differences(aim.value, point), atol=1e-5)
    inputs = aim.training.inputs

    def logits(vector: Real) -> Real:
        return unpacked(vector, network).process(inputs)

    parts = np.exp(logits(point)) / np.exp(logits(point)).sum(axis=1, keepdims=True)
    expected = 1e-3 * np.eye(len(point))
    for row, slopes in zip(parts, np.moveaxis(differences(logits, point), 0, -1), strict=True):
        by_logits = np.diag(row) - np.outer(row, row)
        expected += slopes.T @ by_logits @ slopes / 2
    assert np.allclose(aim.gradient_hessian(point)[1], expected, atol=1e-6)


def test_large_logits_stay_finite() -> None:
    network = NETWORKS[0]
    aim = objective(network)
    for factor in (1e4, 1e8):
        point = factor * packed(network)
        value, gradient = aim.evaluate(point)
        assert np.isfinite([value, *gradient]).all()
        assert np.isfinite(aim.gradient_hessian(point)[1]).all()


@pytest.mark.parametrize("name", tiered(QUICK, ["classes/digits-fast"]))
def test_a_shipped_scene_decides_as_in_floating_point(name: str) -> None:
    found = load_scene(name)
    rows, every = held_out_rows(found), decisions_of(found)
    story = read_provenance(found.weights_paths[0])
    wrong = every.bit_true != every.actual
    assert story["test_wrong_percent"] == round(100 * wrong[rows].mean(), 4)
    assert every.differ <= 2
    assert every.take(rows).right >= 0.95 * len(rows)
    assert not check.classes(found)[1:]


def test_of_equal_outputs_the_first_counts() -> None:
    codes = np.array([[3, 7, 7], [5, 5, 5], [-9, -8, -7]])
    assert decided(codes).tolist() == [1, 0, 2]
    assert margins(codes).tolist() == [0, 0, 1]
