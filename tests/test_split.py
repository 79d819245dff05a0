"""Tests which rows are held out: random rows, blocks of neighbours, or groups."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from golden.input_error import InputError
from golden.scene import Scene, load_scene
from golden.training.split import Split, split_blocks, split_groups, split_of, split_rows

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
@pytest.mark.parametrize(("rows", "block"), [(143, 5), (80, 4), (5000, 50), (16, 1)])
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
def test_blocks_are_half_a_quarter_a_quarter(seed: int) -> None:
    split = split_blocks(np.zeros((160, 0)), 5, seed)
    assert [len(part) for part in parts(split)] == [80, 40, 40]
    assert not np.array_equal(
        split.training, split_blocks(np.zeros((160, 0)), 5, seed + 9).training
    )


@pytest.mark.parametrize("seed", range(5))
def test_groups_are_held_out_whole(seed: int) -> None:
    scene = digit(split="groups", split_by=("load",), seed=seed)
    split, loads = split_of(scene), scene.vectors().targets[:, 0]
    seen = [set(loads[part]) for part in parts(split)]
    assert [len(values) for values in seen] == [4, 2, 2]
    assert len(set.union(*seen)) == 8
    assert sorted(np.concatenate(parts(split))) == list(range(143))


def test_groups_of_several_columns() -> None:
    values = np.stack([np.arange(24) % 2, np.arange(24) % 3], axis=1).astype(float)
    split = split_groups(values, 1)
    seen = [set(map(tuple, values[part])) for part in parts(split)]
    assert [len(pairs) for pairs in seen] == [3, 1, 2]
    assert len(set.union(*seen)) == 6


def test_random_is_what_it_was() -> None:
    scene = digit(split="random")
    for ours, plain in zip(parts(split_of(scene)), parts(split_rows(143, 1)), strict=True):
        assert np.array_equal(ours, plain)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"split": "groups", "split_by": ("shape",)}, "got 2 groups .*expected at least 4"),
        (
            {"split": "blocks", "split_by": (), "block_rows": 99},
            "got 1 blocks of about 99 rows, expected at least",
        ),
        ({"split": "groups", "split_by": ("lood",)}, "no column 'lood'.*did you mean 'load'"),
    ],
)
def test_too_little_to_split(settings: dict[str, Any], message: str) -> None:
    scene = digit(**settings)
    with pytest.raises(InputError, match=message) as caught:
        split_of(scene)
    assert "appendix2.csv" in str(caught.value)
    if "expected at least" in message:
        assert "training.split of " in str(caught.value)
        assert "digit.toml" in str(caught.value)
