"""Tests weights of few digits: how many digits remain, where, and which rows decide that."""

import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError
from golden.networks.constants import constants_of
from golden.numbers.signed_digits import signed_digits
from golden.trained.mlp import Mlp
from tactus.cli import train as command
from tactus.network_files.network_file import provenance_path
from tactus.scene import Scene, load_scene
from tactus.train.descent import few_digits
from tactus.train.descent.few_digits import FewDigits, at_most, count_digits, grid_of, priced
from tactus.train.descent.objective import pack, unpack
from tactus.train.descent.search import train
from tactus.train.descent.stages import Stages
from tactus.train.descent.task import task_for


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
    return FewDigits(task, train(task, 5, 0))


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
    small_scene: Scene, tmp_path: Path, refit: bool, capsys: pytest.CaptureFixture
) -> None:
    scene = asking(small_scene, 40, refit=refit)
    command.train_scene(scene, tmp_path, 1)
    (member,) = scene.members
    story = tomllib.loads(provenance_path(member.weights_path).read_text())
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
        stages.add(hidden, 0)
    assert [digits_in_hardware(scene, mlp) <= 12 for mlp in stages.written] == [True, True]
    codes = stages.task(stages.chosen, 1).recorded.codes
    first = scene.build(stages.written[0]).process(codes[:, :3])
    assert np.array_equal(codes[:, 3:], first)


def test_digits_that_a_network_has_are_left_to_it(small_scene: Scene) -> None:
    few = few_of(small_scene, 1000)
    mlp = few.on_training_rows()
    grid = grid_of(few.chosen, 18)
    assert np.array_equal(pack(mlp), grid.rounded(pack(few.chosen)))
    assert count_digits(mlp, 18) == digits_in_hardware(small_scene, mlp)


def test_the_rest_makes_up_for_what_is_taken_away(small_scene: Scene) -> None:
    """The error is compared with that of weights that are just rounded to two digits."""
    few = few_of(small_scene, 50)
    aim = few.aim(few.task, few.chosen, few.task.training, few.task.split.training)
    start, grid = pack(few.chosen), aim.grid
    plain = grid.rounded(start)
    codes = plain[grid.weights] / grid.lsb[grid.weights]
    plain[grid.weights] = few_digits.nearest_with(codes, 2)[2] * grid.lsb[grid.weights]
    fitted, _ = at_most(aim, start, grid.digits(plain), np.random.default_rng(1))
    assert grid.digits(fitted) <= grid.digits(plain)
    before = aim.value(start)
    assert aim.value(fitted) - before < (aim.value(plain) - before) / 2


def test_a_dearer_digit_leaves_fewer(small_scene: Scene) -> None:
    few = few_of(small_scene, 50)
    aim = few.aim(few.task, few.chosen, few.task.training, few.task.split.training)
    found = [
        aim.grid.digits(priced(aim, pack(few.chosen), price, np.random.default_rng(1)))
        for price in (1e-12, 1e-5, 1e12)
    ]
    assert found[0] > found[1] > found[2] == 0


def test_validation_rows_decide_between_the_starts(
    small_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = few_of(small_scene, 30)
    made: list[Mlp] = []
    original = FewDigits._starts

    def watched(*arguments) -> Iterator[Mlp]:
        for mlp in original(*arguments):
            made.append(mlp)
            yield mlp

    monkeypatch.setattr(FewDigits, "_starts", watched)
    kept = few.on_training_rows()
    errors = [few.errors(mlp) / few.errors(few.chosen) for mlp in made]
    assert len(errors) == 2
    assert few.errors(kept).tolist() in [few.errors(mlp).tolist() for mlp in made]
    assert few.worst(kept) == min(error.max() for error in errors)


def test_the_fewest_digits_keep_to_the_tolerance(small_scene: Scene) -> None:
    """A wider tolerance leaves no more digits."""
    counts = []
    for tolerance in (0.02, 1.0):
        few = few_of(small_scene, "fewest", digits_tolerance=tolerance)
        mlp = few.on_training_rows()
        assert few.worst(mlp) <= 1 + tolerance
        counts.append(digits_in_hardware(small_scene, mlp))
        full = grid_of(few.chosen, 18).digits(pack(few.chosen))
    assert counts[1] <= counts[0] <= full
    assert counts[1] < full


def test_fewest_asks_for_as_many_of_what_has_seen_more_rows(small_scene: Scene) -> None:
    scene = asking(small_scene, "fewest", digits_tolerance=1.0, refit=True)
    stages = Stages(scene)
    stages.add(5, 0)
    chosen, *others = (
        digits_in_hardware(scene, mlps[0])
        for mlps in (stages.chosen, stages.tested, stages.written)
    )
    assert max(others) <= chosen


def test_held_out_rows_take_no_part(small_scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
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
        stages.add(5, 0)
        found.append(stages)
    same = {
        name: np.array_equal(*(pack(getattr(stages, name)[0]) for stages in found))
        for name in ("chosen", "tested", "written")
    }
    assert same == {"chosen": True, "tested": True, "written": False}


def test_what_no_price_leads_to_is_refused(
    small_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(few_digits, "PRICES", (1e-9, 1e-8))
    few = few_of(small_scene, 3)
    with pytest.raises(InputError, match=r"small.toml: training.digits: got 3, expected at least"):
        few.on_training_rows()


def test_a_teacher_stands_between_rows(small_scene: Scene) -> None:
    few = few_of(small_scene, 30)
    aim = few.aim(few.task, few.chosen, few.task.training, few.task.split.training)
    rows = aim.objective.training
    count = len(few.task.training.inputs)
    taught = rows.inputs[count:]
    assert len(taught) == few_digits.TEACHER_FRAMES
    activation = few.task.scene.scheme.real
    assert np.array_equal(rows.targets[count:], few.chosen.process(taught, activation))
    distances = np.abs(taught[:, np.newaxis] - rows.inputs[:count]).max(axis=2)
    assert distances.min() > 0
    assert np.abs(taught).max() <= 1


def test_normalised_weights_are_refused(tmp_path: Path) -> None:
    scene = load_scene("digit-single-thesis")
    text = scene.path.read_text().replace("../data", str(scene.data_path.parent))
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("[training]", "[training]\ndigits = 100"))
    with pytest.raises(InputError, match=r"digits: got 100 with precision 'thesis', .*'exact'"):
        load_scene(str(path))


def test_a_grid_holds_what_the_hardware_holds(small_scene: Scene) -> None:
    mlp = unpack(np.random.default_rng(2).normal(0, 3, 32), (3, 5, 2))
    grid = grid_of(mlp, 18)
    held = unpack(grid.rounded(pack(mlp)), mlp.shape)
    assert grid.digits(pack(mlp)) == digits_in_hardware(small_scene, held)
    assert np.abs(pack(held) - pack(mlp)).max() <= grid.lsb.max() / 2
