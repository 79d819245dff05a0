"""Tests which rows are held out: random rows, blocks of neighbours, or groups."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from golden.input_error import InputError
from tactus.report.draw.outcome import along_plot
from tactus.report.measure.outcome import along, outcome, worst_rows
from tactus.scene import Scene, load_scene
from tactus.scene.vectors import place_names
from tactus.train.split import Split, split_blocks, split_groups, split_of, split_rows
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

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
