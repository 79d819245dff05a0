"""Tests weights of few digits in networks of several layers and in networks for classes."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from test_classes import write_hand
from test_layer_training import scene_of

from golden.engine.quantise import integer_networks
from golden.numbers.signed_digits import signed_digits
from golden.trained.dense import packed
from tactus.cli import train
from tactus.network_files.network_file import read_provenance
from tactus.scene import load_scene
from tactus.train.descent import few_digits
from tactus.train.descent.few_digits import grid_of
from tactus.train.layer_digits import ClassDigits
from tactus.train.layer_training import LayerStages


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reduce the effort to what a small network needs."""
    for name, value in {"STARTS": 2, "TEACHER_FRAMES": 100, "REFITS": 3}.items():
        monkeypatch.setattr(few_digits, name, value)


def trained(path: Path, monkeypatch: pytest.MonkeyPatch) -> dict:
    """Train a scene; its provenance."""
    build = path.parent / "build"
    monkeypatch.setattr(sys, "argv", ["train", str(path), "--workers", "1", "--build", str(build)])
    train.main()
    return dict(read_provenance(load_scene(str(path)).weights_paths[0]))


def digits_in_hardware(path: Path) -> int:
    """The signed digits of the codes of all weights."""
    (network,) = integer_networks("single", load_scene(str(path)).networks())
    rows = [row for layer in network.layers for row in layer.weights]
    return sum(len(signed_digits(code)) for row in rows for code in row)


@pytest.mark.parametrize("refit", ["", "refit = true\n"])
def test_a_network_for_classes_is_written_with_few_digits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refit: str
) -> None:
    path = write_hand(tmp_path, more=f"digits = 24\n{refit}")
    story = trained(path, monkeypatch)
    assert story["digits"] <= 24 < story["digits_before"]
    assert digits_in_hardware(path) <= 24
    assert story["validation_wrong_percent"] <= story["before_validation_wrong_percent"] + 5


def test_a_network_of_several_layers_is_written_with_few_digits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = scene_of(tmp_path, "digits = 60\n")
    story = trained(path, monkeypatch)
    assert story["digits"] <= 60 < story["digits_before"]
    assert digits_in_hardware(path) <= 60


@pytest.mark.all_only
def test_the_fewest_digits_of_a_network_for_classes_keep_to_the_tolerance(tmp_path: Path) -> None:
    """A wider tolerance leaves no more digits."""
    counts = []
    for tolerance in (0.02, 1.0):
        more = f'digits = "fewest"\ndigits_tolerance = {tolerance}\n'
        few = few_of(write_hand(tmp_path, more=more))
        network = few.on_training_rows()
        assert few.worst(network) <= 1 + tolerance
        counts.append(grid_of(few.chosen, 18).digits(packed(network)))
    assert counts[1] < counts[0] < grid_of(few.chosen, 18).digits(packed(few.chosen))


def few_of(path: Path) -> ClassDigits:
    """A network for classes as it was trained, with a request for fewer digits."""
    stages = LayerStages(load_scene(str(path)))
    found: list[ClassDigits] = []

    class Watched(ClassDigits):
        def on_training_rows(self):
            found.append(ClassDigits(self.task, self.chosen))
            return self.chosen

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tactus.train.layer_training.ClassDigits", Watched)
        stages.add((4,), 0)
    return found[0]


def test_the_teacher_of_classes_is_the_trained_network(tmp_path: Path) -> None:
    few = few_of(write_hand(tmp_path, more="digits = 24\n"))
    aim = few.aim(few.task, few.chosen, few.task.training, few.task.split.training)
    rows = aim.objective.training
    assert len(rows.inputs) == len(few.task.training.inputs) + few_digits.TEACHER_FRAMES
    assert np.array_equal(rows.targets, few.chosen.process(rows.inputs))
    assert aim.value(packed(few.chosen)) == 0
    # Without any weight a network errs by about the whole spread of the logits.
    assert 0.5 < aim.value(np.zeros(len(packed(few.chosen)))) < 1.5
