"""Tests training: derivatives, optimisers, early stopping, split, determinism, and results."""

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from refused import call

from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.networks.cascade import Cascade
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import packed, tanh, unpacked
from tactus.cli import train as command
from tactus.network_files.network_file import read_provenance
from tactus.report.draw.outcome import along_plot
from tactus.report.measure.outcome import along, outcome, worst_rows
from tactus.scene import Scene, load_scene, scene_names
from tactus.scene.disturbance import Disturbance
from tactus.scene.vectors import place_names
from tactus.train.objective import OPTIMISERS, Objective, Rows, scg
from tactus.train.search import Result, Stages, candidates, measure, train
from tactus.train.split import Split, split_blocks, split_groups, split_of, split_rows
from tactus.train.task import (
    LEAST_ROWS,
    PARTS,
    REFITTED_ROWS,
    Task,
    bit_true_error,
    signed_errors,
    task_for,
)
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

SHAPE = (3, 4, 2)


def rows(count: int, seed: int = 2) -> Rows:
    rng = np.random.default_rng(seed)
    inputs, targets = rng.uniform(-1, 1, (count, 3)), rng.uniform(0.1, 1, (count, 2))
    return Rows(inputs, targets, np.abs(targets))


def differences(function: Callable[[Real], Any], point: Real) -> Real:
    """The central differences of a function along each coordinate, on the first axis."""
    steps = 1e-6 * np.eye(len(point))
    return np.array([(function(point + s) - function(point - s)) / 2e-6 for s in steps])


@pytest.mark.parametrize("optimiser", OPTIMISERS)
def test_an_optimiser_reaches_a_network_it_can_reach(optimiser: str) -> None:
    rng = np.random.default_rng(4)
    inputs = rng.uniform(-1, 1, (60, 3))
    targets = random_mlp((3, 2, 1), 1.0, 9).process(inputs)
    data = Rows(inputs, targets, np.ones((60, 1)))

    def error(start: int) -> float:
        # There are more nodes than in the network that made the data, so no local minimum is in the
        # way.
        mlp = random_mlp((3, 6, 1), 1.0, start)
        goal = Objective(mlp, data, data, 10_000, tanh, 0.0)
        OPTIMISERS[optimiser](goal, packed(mlp), 5000)
        return float(np.abs(unpacked(goal.best, mlp).process(inputs) - targets).max())

    # A start may stay in a flat valley for long. Which start does depends on the version of SciPy
    # and on last bits of sums.
    assert any(error(start) < 2e-3 for start in range(1, 6))


def test_scg_beyond_a_pole() -> None:
    """The function is NaN beyond 1. A step that lands there must be refused."""

    def walled(x):
        with np.errstate(invalid="ignore"):
            return float(-np.log(1 - x[0]) - 3 * x[0]), np.array([1 / (1 - x[0]) - 3])

    found = scg(SimpleNamespace(evaluate=walled), np.array([-5.0]), 500)
    assert found[0] == pytest.approx(2 / 3, abs=1e-5)


def test_early_stopping_keeps_the_point_of_least_validation_error() -> None:
    mlp = random_mlp(SHAPE, 1.0, 1)
    goal = Objective(mlp, rows(9), rows(5, 3), 10_000, tanh, 0.0)
    start = packed(mlp)
    seen = []
    original = goal.residuals

    def spy(vector):
        result = original(vector)
        seen.append(vector.copy())
        return result

    goal.residuals = spy
    OPTIMISERS["levenberg-marquardt"](goal, start, 300)
    lowest, errors = np.inf, []
    for vector in seen:
        mlp = unpacked(vector, goal.like)
        value, held_back = (
            float((part.errors(mlp.process(part.inputs)) ** 2).sum())
            for part in (goal.training, goal.validation)
        )
        if value < lowest:
            lowest = value
            errors.append((held_back, vector))
    assert np.array_equal(goal.best, min(errors, key=lambda pair: pair[0])[1])
    assert not np.array_equal(goal.best, errors[-1][1]), "the data do not overfit: no proof"


def test_a_candidate_depends_on_seed_and_numbers_alone(small_scene: Scene) -> None:
    def weights(scene: Scene, hidden: int, restart: int):
        return packed(train(task_for(scene, scene.vectors(), []), (hidden,), restart))

    first = weights(small_scene, 5, 1)
    assert np.array_equal(first, weights(small_scene, 5, 1))
    other = replace(small_scene, training=replace(small_scene.training, seed=9))
    assert not np.array_equal(first, weights(other, 5, 1))
    assert not np.array_equal(first, weights(small_scene, 5, 2))


@pytest.mark.parametrize("activation", SCHEMES)
def test_every_activation_can_be_trained(small_scene: Scene, activation: str) -> None:
    """The bit-true network is also close to the trained one."""
    design = "adder_graph" if SCHEMES[activation].half_codes else small_scene.design
    scene = replace(small_scene, activation=activation, design=design)
    vectors = scene.vectors()
    mlp = train(task_for(scene, vectors, []), (5,), 1)
    results = SIGNAL.to_real(scene.build(mlp).process(vectors.codes))
    exact = np.clip(mlp.process(vectors.inputs, scene.scheme.real), -1, SIGNAL.high / 8192)
    # A q on the other side of a border adds the step of the scheme there, which is at most 0.03.
    assert (
        np.abs(results - exact).max()
        < 0.002 + 0.03 * np.abs(mlp.layers[1].weights).sum(axis=1).max()
    )
    spread = np.abs(results - vectors.targets).mean()
    assert spread < np.abs(vectors.targets - vectors.targets.mean(axis=0)).mean()


@pytest.mark.parametrize("name", scene_names())
def test_shipped_networks_have_the_errors_of_their_provenance(name: str) -> None:
    """The errors are those of the design for which they were trained, as other designs use them
    too.

    As in training, networks pass on outputs of 14 bits. An engine keeps 18 bits between networks.
    """
    scene = load_scene(name)
    first = read_provenance(scene.members[0].weights_path)
    scene = replace(scene, design=first["design"], design_options={})
    vectors = scene.vectors()
    cascade = scene.arrangement == "cascade"
    network = Cascade(tuple(map(scene.build, scene.mlps()))) if cascade else scene.twin().core
    results = SIGNAL.to_real(network.process(vectors.codes))
    errors = vectors.percent_errors(results)
    split = split_of(scene)
    for member in scene.members:
        provenance = read_provenance(member.weights_path)
        assert provenance["design"] == scene.design
        # Older files without these keys were split at random, and not refitted.
        assert provenance.get("split", "random") == scene.training.split
        assert provenance.get("refit", False) == scene.training.refit
        columns = [scene.outputs.index(name) for name in member.outputs]
        # A refitted network has seen all rows. The errors on parts belong to other networks.
        parts = {"every": np.arange(len(errors))}
        if not scene.training.refit:
            parts |= {"validation": split.validation, "test": split.test}
        for part, rows in parts.items():
            if f"{part}_rms_percent" not in provenance:
                assert part == "every", "only those written before the key was there lack it"
                continue
            rms = np.sqrt((errors[rows][:, columns] ** 2).mean())
            assert rms == pytest.approx(provenance[f"{part}_rms_percent"], abs=1e-3)
        assert provenance["network"] == ":".join(str(n) for n in member.load().shape)


def test_a_network_of_a_cascade_sees_what_the_scene_says(small_cascade: Scene) -> None:
    vectors, mlps = small_cascade.vectors(), small_cascade.mlps()
    results = small_cascade.twin().process(vectors.codes)
    real = small_cascade.process_real(SIGNAL.to_real(vectors.codes))
    for loop, given in (("bit-true", SIGNAL.to_real(results)), ("float", real)):
        training = replace(small_cascade.training, earlier_outputs=loop)
        task = task_for(replace(small_cascade, training=training), vectors, mlps[:2])
        frames = task.recorded
        assert np.array_equal(frames.codes, np.hstack([vectors.codes, results[:, :2]]))
        assert np.array_equal(frames.inputs[:, :3], SIGNAL.to_real(vectors.codes))
        assert np.allclose(frames.inputs[:, 3:], given[:, :2], atol=1e-12)
        assert np.array_equal(frames.targets, vectors.targets[:, 2:])
        assert np.array_equal(task.bit_true(mlps[2], frames), SIGNAL.to_real(results[:, 2:]))


def disturbed(scene: Scene, **sizes: float) -> Scene:
    return replace(scene, training=replace(scene.training, disturbance=Disturbance(**sizes)))


def test_every_network_of_a_cascade_sees_the_same_disturbed_readings(small_cascade: Scene) -> None:
    """It also gets the bit-true outputs of the networks before it."""
    scene, mlps = disturbed(small_cascade, noise=0.01), small_cascade.mlps()
    first, second = (task_for(scene, scene.vectors(), mlps[:n]) for n in (0, 1))
    for part in PARTS:
        before, after = getattr(first, part), getattr(second, part)
        assert np.array_equal(after.codes[:, :3], before.codes)
        assert np.array_equal(after.codes[:, 3:], scene.build(mlps[0]).process(before.codes))
        rows, least = first.rows(part), LEAST_ROWS.get(part, REFITTED_ROWS)
        assert least <= len(before.codes) < least + len(rows)
        assert len(before.codes) % len(rows) == 0
        assert np.array_equal(
            before.targets,
            np.tile(first.recorded.targets[rows], (len(before.codes) // len(rows), 1)),
        )


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ({"noise": 0.01}, lambda x: 0.01 * np.ones_like(x)),
        ({"offset": 0.01}, lambda x: 0.01 * np.ones_like(x)),
        ({"gain": 0.01}, lambda x: 0.01 * np.abs(x)),
    ],
)
def test_parts_are_disturbed_by_as_much_as_the_scene_says(
    small_scene: Scene, sizes: dict[str, float], expected
) -> None:
    scene = disturbed(small_scene, **sizes)
    task = task_for(scene, scene.vectors(), [])
    for part in PARTS:
        frames, rows = getattr(task, part), task.rows(part)
        recorded = np.tile(scene.vectors().inputs[rows], (len(frames.inputs) // len(rows), 1))
        inside = np.abs(recorded) < 0.9  # the format's ends clip the others
        moved = ((frames.inputs - recorded) / expected(recorded))[inside & (recorded != 0)]
        # The deviation of 600 or more draws is within 15 %, which is more than four of its own
        # deviations.
        assert moved.std() == pytest.approx(1, rel=0.15)
        assert abs(moved.mean()) < 0.2


@pytest.mark.parametrize("refit", [False, True])
def test_provenance_states_split_disturbance_and_both_errors(
    small_scene: Scene, tmp_path: Path, refit: bool
) -> None:
    scene = disturbed(small_scene, noise=0.02, gain=0.01)
    training = replace(scene.training, split="blocks", block_rows=2, restarts=1, refit=refit)
    scene = replace(scene, training=training)
    command.train_scene(scene, tmp_path, 1)
    (member,) = scene.members
    story = read_provenance(member.weights_path)
    assert [story[key] for key in ("split", "split_by", "block_rows")] == ["blocks", "", 2]
    assert [story[key] for key in ("noise", "drift_gain", "drift_offset")] == [0.02, 0.01, 0]
    assert story["refit"] is refit
    stages = Stages(scene)
    stages.add((scene.members[0].hidden,), story["best_restart"])
    assert np.array_equal(packed(stages.written[0]), packed(member.load()))
    task = stages.task([], 0)
    for part, mlp in (("validation", stages.chosen[0]), ("test", stages.tested[0])):
        recorded = task.recorded.take(getattr(task.split, part))
        for name, frames in (("", recorded), ("_disturbed", getattr(task, part))):
            error = bit_true_error(task, mlp, frames)
            assert story[f"{part}{name}_rms_percent"] == round(error, 4)
            means = np.abs(signed_errors(task, mlp, frames)).mean(axis=0)
            assert list(story[f"{part}{name}_mean_percent"].values()) == list(means.round(4))
    written = bit_true_error(task, member.load(), task.recorded)
    assert story["every_rms_percent"] == round(written, 4)


def test_a_cascade_is_written_whole_or_not_at_all(
    small_cascade: Scene, tmp_path: Path, monkeypatch
) -> None:
    before = [path.read_bytes() for path in small_cascade.weights_paths]
    original = command.choose

    def fail_late(task: Task, record: Path, workers: int):
        if task.number == 2:
            raise InputError("no candidate fits")
        return original(task, record, workers)

    monkeypatch.setattr(command, "choose", fail_late)
    with pytest.raises(InputError, match="no candidate fits"):
        call("train", small_cascade.path, "--build", tmp_path, "--workers", 1)
    assert [path.read_bytes() for path in small_cascade.weights_paths] == before


def searched(scene: Scene, record: Path, workers: int = 1) -> list[Result]:
    """The results of 3 sizes with 2 starts each."""
    members = (replace(scene.members[0], hidden=0),)
    scene = replace(scene, members=members, training=replace(scene.training, hidden=(2, 4)))
    task = task_for(scene, scene.vectors(), [])
    return list(command.continued(measure, task, candidates(task), record, workers))


def test_a_search_that_goes_on_with_other_workers_gives_the_same_record(
    small_scene: Scene, tmp_path: Path
) -> None:
    here, there = tmp_path / "here.jsonl", tmp_path / "there.jsonl"
    found = searched(small_scene, here)
    there.write_text(here.read_text()[: -len(here.read_text().splitlines()[-1]) // 2])
    assert searched(small_scene, there, workers=2) == found
    assert there.read_bytes() == here.read_bytes()


SAME = ("load", "width", "shape")


def digit(**settings: Any) -> Scene:
    scene = load_scene("digit")
    return replace(scene, training=replace(scene.training, **settings))


def parts(split: Split) -> list[np.ndarray]:
    return [split.training, split.validation, split.test]


def interpolated(scene: Scene) -> np.ndarray:
    """Rows whose first three sensors are the mean of the neighbouring places, up to rounding."""
    readings, targets = scene.vectors().inputs[:, :3], scene.vectors().targets[:, [0, 2, 3]]
    between = (targets[:-2] == targets[1:-1]).all(axis=1) & (targets[2:] == targets[1:-1]).all(
        axis=1
    )
    mean = (readings[:-2] + readings[2:]) / 2
    return 1 + np.flatnonzero(between & (np.abs(readings[1:-1] - mean) < 6e-5).all(axis=1))


def told_by_training(split: Split, rows: np.ndarray) -> list[int]:
    """The held-out rows among these, both of whose neighbours are training rows."""
    held_out = rows[~np.isin(rows, split.training)]
    return [row for row in held_out if np.isin([row - 1, row + 1], split.training).all()]


@pytest.mark.parametrize("seed", range(20))
def test_blocks_keep_interpolated_rows_from_their_neighbours(seed: int) -> None:
    scene = digit(split="blocks", split_by=SAME, seed=seed)
    rows = interpolated(scene)
    assert len(rows) == 66
    assert told_by_training(split_of(scene), rows) == []
    assert told_by_training(split_of(digit(split="random", seed=seed)), rows)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(("rows", "block"), [(143, 5), (80, 4), (16, 1)])
def test_blocks_are_stretches_of_one_run(rows: int, block: int, seed: int) -> None:
    run = np.arange(rows)[:, np.newaxis] * 8 // rows  # eight runs
    split = split_blocks(run, block, seed)
    assert sorted(np.concatenate(parts(split))) == list(range(rows))
    # A part may hold blocks that follow each other. None of its stretches is shorter than a block.
    least = min(block, rows // 8) if block > 1 else 1
    for part in parts(split):
        joined = np.split(part, np.flatnonzero(np.diff(part) != 1) + 1)
        assert min(map(len, joined)) >= 0.6 * least
    assert set(run[split.training].ravel()) == set(range(8)), "a run has nothing that trains"


@pytest.mark.parametrize("seed", range(5))
def test_groups_are_held_out_whole(seed: int) -> None:
    scene = digit(split="groups", split_by=("load",), seed=seed)
    split, loads = split_of(scene), scene.vectors().targets[:, 0]
    seen = [set(loads[part]) for part in parts(split)]
    assert [len(values) for values in seen] == [4, 2, 2]
    assert len(set.union(*seen)) == 8
    assert sorted(np.concatenate(parts(split))) == list(range(143))


@pytest.mark.parametrize("groups", [2, 3])
def test_of_few_groups_one_is_held_out(groups: int) -> None:
    values = (np.arange(36.0) % groups)[:, None]
    split = split_groups(values, 1)
    training, validation, test = ({*values[part, 0]} for part in parts(split))
    assert len(test) == 1
    assert test.isdisjoint(training | validation)
    assert sorted(np.concatenate(parts(split))) == list(range(36))
    assert len(split.training) == 2 * len(split.validation)
    with pytest.raises(InputError, match=r"got 1 groups .*expected at least 2"):
        split_groups(values[::groups], 1)


def test_the_split_at_random_is_50_25_25_and_covers_every_row() -> None:
    split = split_of(digit(split="random"))
    assert [len(part) for part in parts(split)] == [71, 35, 37]
    assert sorted(np.concatenate(parts(split))) == list(range(143))
    assert np.array_equal(split.training, split_rows(143, 1).training)
    assert not np.array_equal(split.training, split_rows(143, 2).training)
    with pytest.raises(InputError, match="got 7 rows, expected at least 8"):
        split_rows(7, 1)


PERSONS = ("anna", "bert", "carl", "dora", "emil", "fay")


@pytest.fixture
def people(tmp_path: Path) -> Path:
    """The folder of two recordings of persons, one of whom is in both."""
    rows = np.random.default_rng(1).uniform(-0.9, 0.9, (120, 5)).round(3)
    for name, first in (("early", 0), ("late", 60)):
        lines = ["x0,x1,x2,y0,y1,person,hand"]
        for number, row in enumerate(rows[first : first + 60], first):
            cells = *map(str, row), PERSONS[number // 21], ("left", "right")[number % 2]
            lines.append(",".join(cells))
        (tmp_path / f"{name}.csv").write_text("\n".join(lines) + "\n")
    return tmp_path


def of_people(folder: Path, where: str = '{ hand = "left" }') -> Scene:
    write_scene(folder, "people", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    path = folder / "people.toml"
    text = re.sub("file = .*", 'recordings = ["early.csv", "late.csv"]', path.read_text())
    text = text.replace('group_by = "y0"', f'group_by = "person"\nwhere = {where}')
    split = '[training]\nsplit = "groups"\nsplit_by = ["person"]'
    path.write_text(text.replace("[training]", split))
    return load_scene(str(path))


def test_persons_are_held_out_by_name(people: Path) -> None:
    scene = of_people(people)
    names = [place_names(scene)[group] for group in scene.vectors().groups]
    assert names == [PERSONS[number // 21] for number in range(0, 120, 2)]
    held = [{names[row] for row in part} for part in parts(split_of(scene))]
    assert set.union(*held) == set(PERSONS)
    assert sum(map(len, held)) == len(PERSONS), "no person is in two parts"
    found = outcome(scene)
    table = along(found)
    assert {row[0]: row[1] for row in table.rows} == Counter(names)
    assert any(f"at {name}, " in along_plot(found, table).sentence for name in PERSONS)
    assert {row[-4] for row in worst_rows(found).rows} <= set(PERSONS)


@pytest.mark.parametrize(
    ("where", "said"),
    [
        ('{ hand = "lefd" }', r"early\.csv: no row has hand = 'lefd', .*did you mean 'left'"),
        ("{ hand = 1 }", r"early\.csv: column 'hand' holds texts such as 'left', got 1, expected"),
        ('{ hnad = "left" }', r"early\.csv: no column 'hnad', .*did you mean 'hand'"),
    ],
)
def test_a_text_that_no_row_has_is_refused(people: Path, where: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        of_people(people, where).vectors()
