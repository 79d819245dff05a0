"""Tests weights of few digits, and the signed digits that they are counted in."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_classes import write_hand
from test_layer_training import scene_of, trained

from golden.engine.quantise import integer_networks
from golden.networks.constants import constants_of
from golden.numbers.signed_digits import digit_counts, nearest_with, short_forms, signed_digits
from golden.trained.dense import packed
from golden.trained.mlp import Mlp
from tactus.cli import train as command
from tactus.network_files.network_file import read_provenance
from tactus.scene import Scene, load_scene
from tactus.train import few_digits
from tactus.train.few_digits import FewDigits, grid_of
from tactus.train.search import Stages, train
from tactus.train.task import task_for


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reduce the effort to what a small network needs."""
    for name, value in {"STARTS": 2, "TEACHER_FRAMES": 100, "REFITS": 3}.items():
        monkeypatch.setattr(few_digits, name, value)


def asking(scene: Scene, digits: int | str, **settings) -> Scene:
    training = replace(scene.training, digits=digits, restarts=1, **settings)
    return replace(scene, training=training)


def few_of(scene: Scene, digits: int | str, **settings) -> FewDigits:
    """A network of a scene as it was trained, with a request for fewer digits."""
    task = task_for(asking(scene, digits, **settings), scene.vectors(), [])
    return FewDigits(task, train(task, (5,), 0), layered=False)


def digits_in_hardware(scene: Scene, mlp: Mlp) -> int:
    """The digits of the codes with which designs compute. These codes must equal the weights."""
    found = constants_of(mlp, scene.settings(lean=False))
    for layer, weights, biases in ((found.first, mlp.w1, mlp.b1), (found.second, mlp.w2, mlp.b2)):
        assert np.array_equal(layer.fmt.to_real(layer.weights), weights)
        assert np.array_equal(layer.fmt.to_real(layer.biases), biases)
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
        few = few_of(small_scene, "fewest", digits_tolerance=tolerance)
        mlp = few.on_training_rows()
        assert few.worst(mlp) <= 1 + tolerance
        counts.append(digits_in_hardware(small_scene, mlp))
        full = grid_of(few.chosen, 18).digits(packed(few.chosen))
    assert counts[1] <= counts[0] <= full
    assert counts[1] < full


@pytest.mark.all_only
def test_held_out_rows_take_no_part(small_scene: Scene) -> None:
    """If their readings and targets are replaced, only the written network may change."""
    scene = asking(small_scene, 30, refit=True)
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


def test_short_forms_are_all_forms_of_so_few_digits():
    every = {}
    for signs in product((-1, 0, 1), repeat=9):
        form = tuple((place, sign) for place, sign in enumerate(signs) if sign)
        every.setdefault(sum(sign << place for place, sign in form), set()).add(form)
    for number in range(-40, 41):
        for most in range(len(signed_digits(number)) + 2):
            fitting = {form for form in every[number] if len(form) <= most}
            found = short_forms(number, most)
            assert set(found) == fitting
            assert len(found) == len(fitting)


@given(st.floats(-1000, 1000), st.integers(0, 5))
def test_no_number_of_so_few_digits_is_nearer(value, most):
    """It is compared with all numbers below twice its value."""
    (found,) = nearest_with(np.array([value]), most)[most]
    assert len(signed_digits(int(found))) <= most
    numbers = np.arange(-2048, 2049)
    least = np.abs(numbers[digit_counts(numbers) <= most] - value).min()
    assert abs(found - value) == least


def provenance_of(path: Path) -> dict:
    """Train a scene; its provenance."""
    trained(path)
    return dict(read_provenance(load_scene(str(path)).weights_paths[0]))


def digits_of_layers(path: Path) -> int:
    """The signed digits of the codes of all weights."""
    (network,) = integer_networks("single", load_scene(str(path)).networks())
    rows = [row for layer in network.layers for row in layer.weights]
    return sum(len(signed_digits(code)) for row in rows for code in row)


@pytest.mark.parametrize("refit", ["", "refit = true\n"])
def test_a_network_for_classes_is_written_with_few_digits(tmp_path: Path, refit: str) -> None:
    path = write_hand(tmp_path, more=f"digits = 24\n{refit}")
    story = provenance_of(path)
    assert story["digits"] <= 24 < story["digits_before"]
    assert digits_of_layers(path) <= 24
    assert story["validation_wrong_percent"] <= story["before_validation_wrong_percent"] + 5


def test_a_network_of_several_layers_is_written_with_few_digits(tmp_path: Path) -> None:
    path = scene_of(tmp_path, "digits = 60\n")
    story = provenance_of(path)
    assert story["digits"] <= 60 < story["digits_before"]
    assert digits_of_layers(path) <= 60
