"""Training of networks whose layers the scene names, and of weights of few digits."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine
from hypothesis import given
from hypothesis import strategies as st
from refused import call
from test_classes import write_hand
from test_training import differences

from golden.activation.segments import gradient_real
from golden.engine.quantise import integer_networks
from golden.input_error import InputError
from golden.networks.constants import constants_of
from golden.numbers.precision import SIGNAL
from golden.numbers.signed_digits import digit_counts, nearest_with, signed_digits
from golden.trained.dense import ACTIVATIONS, Activation, DenseNetwork, network_of, packed, tanh
from golden.trained.function import Function
from tactus.cli import train as command
from tactus.errors import held_out_rows
from tactus.network_files.network_file import read_provenance
from tactus.rig.check import design
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.train import few_digits, search
from tactus.train.few_digits import Rounding, growth, importance_of, selected
from tactus.train.objective import Objective, Rows
from tactus.train.search import Result, Stages, train
from tactus.train.task import task_for
from tb.common.cases import random_network


def objective(network: DenseNetwork, of_tanh: Activation) -> Objective:
    rng = np.random.default_rng(3)
    inputs, outputs = network.shape[0], network.shape[-1]
    parts = [
        Rows(
            rng.normal(0, 1, (n, inputs)), rng.normal(0, 1, (n, outputs)), np.full((n, outputs), 2)
        )
        for n in (7, 5)
    ]
    return Objective(network, *parts, 9, of_tanh, 1e-3)


def leaky(network: DenseNetwork) -> DenseNetwork:
    """Every leaky ReLU with a slope that shows."""
    return network_of([replace(layer, leak=0.3) for layer in network.layers])


OWN = Function("wave", "sin(2 * x)"), Function("bell", "exp(-x * x)")
NETWORKS = [
    leaky(random_network((3, 4, 2), (kind,), 1.0, seed)) for seed, kind in enumerate(ACTIVATIONS)
] + [
    leaky(random_network((2, 4, 3, 5, 2), ("relu", "sigmoid", "leaky_relu"), 1.0, 9)),
    random_network((2, 3, 4, 2), ("table:wave,bell,wave", "table:bell"), 1.0, 4, functions=OWN),
]


@pytest.mark.parametrize("of_tanh", [tanh, gradient_real])
@pytest.mark.parametrize("network", NETWORKS, ids=lambda n: "-".join(map(str, n.shape)))
def test_gradient_and_jacobian_are_the_differences(
    network: DenseNetwork, of_tanh: Activation
) -> None:
    aim, point = objective(network, of_tanh), packed(network)
    value, gradient = aim.evaluate(point)
    residuals, slopes = aim.residuals(point), aim.jacobian(point)
    assert value == pytest.approx(float(residuals @ residuals))
    assert np.allclose(gradient, differences(aim.value, point), atol=1e-5)
    assert np.allclose(slopes.T, differences(aim.residuals, point), atol=1e-6)
    assert np.allclose(aim.gradient_hessian(point)[1], slopes.T @ slopes)


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
    assert (story["network"], story["hidden"]) == ("3:4:4:2", "4 relu, 4 relu")
    assert story["test_rms_percent"] < 5
    # What it was not trained on is known.
    rows = held_out_rows(scene)
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
    monkeypatch.setattr(command, "FIRST_ROWS", 10)
    measure, seen = search.measure, []

    def watched(task, hidden, restart):
        if len(seen) == 11:
            raise KeyboardInterrupt
        result = measure(task, hidden, restart)
        seen.append((task.number, len(task.training.inputs), result))
        return result

    monkeypatch.setattr(search, "measure", watched)
    with pytest.raises(KeyboardInterrupt):
        trained(path)
    seen.append((None, 0, None))
    trained(path)
    for number, name in enumerate(("mine-0.npz", "mine-1.npz")):
        rows: dict[int, list] = {}
        for _, count, result in (one for one in seen if one[0] == number):
            rows.setdefault(count, []).append(result)
        assert {count: len(found) for count, found in rows.items()} == {10: 10, 20: 5, 30: 3}
        better = sorted(rows[10], key=lambda result: result.rank)[:5]
        went_on = [(one.layers, one.restart) for one in rows[20]]
        assert went_on == [(one.layers, one.restart) for one in better]
        story = read_provenance(tmp_path / name)
        best = min(rows[30], key=lambda result: result.rank)
        assert abs(story["validation_rms_percent"] - best.validation) < 1e-3


def test_candidates_refused_on_few_rows_are_counted(tmp_path: Path, monkeypatch) -> None:
    results = iter(
        [
            [Result((n,), 0, n, refused="too large" * (n > 2)) for n in (1, 2, 3, 4)],
            [Result((n,), 0, n) for n in (1, 2)],
        ]
    )
    scene = load_scene(str(scene_of(tmp_path)))
    task = task_for(scene, scene.vectors(), [])
    monkeypatch.setattr(command, "has_many_rows", lambda scene: True)
    monkeypatch.setattr(command, "parts_of", lambda task: [task, task])
    monkeypatch.setattr(command, "compared", lambda *_: next(results))
    best, refused = command.choose(task, tmp_path / "0.jsonl", 1)
    assert (best.layers, refused) == ((1,), 2)


def test_a_search_for_layers_beside_fixed_activations_is_refused(tmp_path: Path) -> None:
    path = scene_of(tmp_path, "layers = [1, 2]\n")
    path.write_text(path.read_text().replace("hidden = [4, 4]", 'activations = ["relu"]'))
    message = "mine.toml: network.activations: got ['relu'] with training.layers [1, 2], expected"
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


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reduce the effort to what a small network needs."""
    for name, value in {"STARTS": 2, "TEACHER_FRAMES": 100, "REFITS": 3}.items():
        monkeypatch.setattr(few_digits, name, value)


def asking(scene: Scene, digits: int | str, **settings) -> Scene:
    training = replace(scene.training, digits=digits, restarts=1, **settings)
    return replace(scene, training=training)


def digits_in_hardware(scene: Scene, mlp: DenseNetwork) -> int:
    """The digits of the codes with which designs compute. These codes must equal the weights."""
    found = constants_of(mlp, scene.settings(lean=False))
    for layer, real in zip((found.first, found.second), mlp.layers, strict=True):
        assert np.array_equal(layer.fmt.to_real(layer.weights), real.weights)
        assert np.array_equal(layer.fmt.to_real(layer.biases), real.biases)
    rows = [*found.first.weights, *found.second.weights]
    return sum(len(signed_digits(code)) for row in rows for code in row)


@pytest.mark.parametrize("refit", [False, True])
def test_a_network_is_written_with_as_many_digits_as_asked_for(
    small_scene: Scene, tmp_path: Path, refit: bool, capsys
) -> None:
    scene = asking(small_scene, 40, refit=refit)
    command.train_scene(scene, tmp_path, 1)
    (member,) = scene.members
    story = read_provenance(member.weights_path)
    kept = digits_in_hardware(scene, member.load())
    assert kept <= 40 < story["digits_before"]
    assert [story["digits_asked"], story["digits_tolerance"], story["digits"]] == [40, 0, kept]
    assert f"{kept} signed digits of {story['digits_before']}" in capsys.readouterr().out
    for part in ("validation", "test", "every"):
        before, after = (story[f"{kind}{part}_mean_percent"].values() for kind in ("before_", ""))
        assert len(before) == len(after) == 2
        assert list(before) != list(after)


def test_a_network_of_a_cascade_sees_what_few_digits_make_of_the_earlier_ones(
    small_cascade: Scene,
) -> None:
    scene = asking(small_cascade, 12)
    stages = Stages(scene)
    for hidden in (4, 3):
        stages.add((hidden,), 0)
    assert [digits_in_hardware(scene, mlp) <= 12 for mlp in stages.written] == [True, True]
    codes = stages.task(stages.chosen, 1).recorded.codes
    first = scene.build(stages.written[0]).process(codes[:, :3])
    assert np.array_equal(codes[:, 3:], first)


def test_the_fewest_digits_keep_to_the_tolerance(small_scene: Scene) -> None:
    """A wider tolerance leaves no more digits."""
    counts = []
    for tolerance in (0.02, 1.0):
        asked = asking(small_scene, "fewest", digits_tolerance=tolerance)
        task = task_for(asked, small_scene.vectors(), [])
        network = train(task, (5,), 0)
        few = Rounding(task, network, "training", importance_of(task, network), layered=False)
        mlp = selected(few)
        assert growth(task, network, mlp) <= 1 + tolerance
        counts.append(digits_in_hardware(small_scene, mlp))
        full = few.grid.digits(few.start)
    assert counts[1] <= counts[0] <= full
    assert counts[1] < full


@pytest.mark.parametrize("digits", [pytest.param(30, marks=pytest.mark.all_only), 0])
def test_held_out_rows_take_no_part(small_scene: Scene, digits: int) -> None:
    """If their readings and targets are replaced, only the written network may change."""
    noise = Disturbance(noise=0.002)
    scene = asking(small_scene, digits, refit=True, steps=30, disturbance=noise)
    split = task_for(scene, scene.vectors(), []).split
    found = []
    for moved in (False, True):
        lines = scene.data_path.read_text().splitlines()
        if moved:
            for row in split.test:
                cells = lines[1 + row].split(",")
                lines[1 + row] = ",".join(["0.25"] * len(cells))
        path = scene.data_path.with_name(f"moved{moved}.csv")
        path.write_text("\n".join(lines))
        stages = Stages(replace(scene, data_paths=(path,)))
        stages.add((5,), 0)
        found.append(stages)
    same = {
        name: np.array_equal(*(packed(getattr(stages, name)[0]) for stages in found))
        for name in ("chosen", "tested", "written")
    }
    assert same == {"chosen": True, "tested": True, "written": False}


@given(st.integers())
def test_they_stand_for_the_number(number):
    assert sum(sign << place for place, sign in signed_digits(number)) == number


def test_no_other_form_has_fewer():
    """No number that so many digits in ten places can form is written with more digits."""
    fewest = {0: 0}
    for count in range(1, 6):
        for number in list(fewest):
            for place in range(10):
                for sign in (1, -1):
                    fewest.setdefault(number + (sign << place), count)
    checked = [number for number in range(-200, 201) if number in fewest]
    assert len(checked) == 401
    for number in checked:
        assert len(signed_digits(number)) == fewest[number]


@given(st.floats(-1000, 1000), st.integers(0, 5))
def test_no_number_of_so_few_digits_is_nearer(value, most):
    """It is compared with all numbers below twice its value."""
    (found,) = nearest_with(np.array([value]), most)[most]
    assert len(signed_digits(int(found))) <= most
    numbers = np.arange(-2048, 2049)
    least = np.abs(numbers[digit_counts(numbers) <= most] - value).min()
    assert abs(found - value) == least


def digits_of_layers(path: Path) -> int:
    """The signed digits of the codes of all weights."""
    (network,) = integer_networks("single", load_scene(str(path)).networks())
    rows = [row for layer in network.layers for row in layer.weights]
    return sum(len(signed_digits(code)) for row in rows for code in row)


@pytest.mark.parametrize("refit", ["", "refit = true\n"])
def test_a_network_for_classes_is_written_with_few_digits(tmp_path: Path, refit: str) -> None:
    path = write_hand(tmp_path, more=f"digits = 24\n{refit}")
    trained(path)
    story = read_provenance(path.with_suffix(".npz"))
    assert story["digits"] <= 24 < story["digits_before"]
    assert digits_of_layers(path) <= 24
    assert story["validation_wrong_percent"] <= story["before_validation_wrong_percent"] + 5


def test_a_network_of_several_layers_is_written_with_few_digits(tmp_path: Path) -> None:
    path = scene_of(tmp_path, "digits = 60\n")
    trained(path)
    story = read_provenance(path.with_suffix(".npz"))
    assert story["digits"] <= 60 < story["digits_before"]
    assert digits_of_layers(path) <= 60
