"""Which rows train a network, which choose it, and which are kept out of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from golden.networks.mlp import Real
from golden.table import read_table, rows_where

if TYPE_CHECKING:
    from golden.scene import Scene

Numbers = NDArray[np.int64]

# Half of the blocks train, a quarter chooses, a quarter tests; of any two in a row one trains.
PARTS = ("training", "validation", "training", "test")


@dataclass(frozen=True)
class Split:
    """Row numbers of the training, validation and test rows: about 50, 25 and 25 % of all."""

    training: Numbers
    validation: Numbers
    test: Numbers


def split_of(scene: Scene) -> Split:
    """The split that ``training.split`` of a scene names.

    Raises
    ------
    ValueError
        For too few rows, blocks or groups, or a column of ``training.split_by`` that is not there.
    """
    settings = scene.training
    values = _columns(scene)
    place = f"{scene.data_path}: training.split of {scene.path}"
    if settings.split == "blocks":
        return split_blocks(values, settings.block_rows, settings.seed, place)
    if settings.split == "groups":
        return split_groups(values, settings.seed, place)
    return split_rows(len(values), settings.seed, place)


def split_story(scene: Scene) -> dict[str, str | int]:
    """What the provenance of a network says of the rows: whoever reads the same has this split."""
    settings = scene.training
    return {
        "data": scene.data_path.name,
        "rows": len(scene.vectors().codes),
        "seed": settings.seed,
        "split": settings.split,
        "split_by": ", ".join(settings.split_by),
        "block_rows": settings.block_rows if settings.split == "blocks" else 0,
    }


def _columns(scene: Scene) -> Real:
    """The columns of ``training.split_by``, in the rows that the scene uses."""
    kept = rows_where(scene.data_path, scene.where)
    return read_table(scene.data_path, scene.training.split_by)[kept]


def split_rows(rows: int, seed: int, place: str = "rows") -> Split:
    """A random split of ``rows`` rows.

    Raises
    ------
    ValueError
        For fewer than 8 rows: a part would hold a single row or none.
    """
    if rows < 8:
        raise ValueError(f"{place}: got {rows} rows, expected at least 8 to split in 50, 25, 25 %")
    return _halves(rows, seed)


def split_groups(values: Real, seed: int, place: str = "groups") -> Split:
    """Rows with the same ``values`` stay together; the groups are split at random.

    Parameters
    ----------
    values : float array, shape (rows, columns)
    seed : int
    place : str
        What a message names.

    Raises
    ------
    ValueError
        For fewer than 4 groups: a part would have none.
    """
    groups, member = np.unique(values, axis=0, return_inverse=True)
    if len(groups) < 4:
        raise ValueError(
            f"{place}: got {len(groups)} groups of rows with the same training.split_by, expected "
            "at least 4 to split in 50, 25, 25 %"
        )
    chosen = _halves(len(groups), seed)
    return Split(
        *(
            np.flatnonzero(np.isin(member.ravel(), part))
            for part in (chosen.training, chosen.validation, chosen.test)
        )
    )


def split_blocks(values: Real, block_rows: int, seed: int, place: str = "blocks") -> Split:
    """Stretches of rows that follow each other in the file stay together.

    A run is a stretch in which ``values`` do not change, the whole file where there are none. It
    is cut into blocks of ``block_rows`` rows, as near as equal ones come. The blocks of a run, in
    random order, and after it those of the next, are dealt out to ``PARTS`` in turn, so that every
    run of two blocks or more has one that trains.

    Parameters
    ----------
    values : float array, shape (rows, columns)
    block_rows : int
    seed : int
    place : str
        What a message names.

    Raises
    ------
    ValueError
        For fewer than 4 blocks: a part would have none.
    """
    borders = np.flatnonzero((values[1:] != values[:-1]).any(axis=1)) + 1
    rng = np.random.default_rng(seed)
    blocks: list[Numbers] = []
    for run in np.split(np.arange(len(values)), borders):
        parts = np.array_split(run, max(1, round(len(run) / block_rows)))
        blocks += [parts[n] for n in rng.permutation(len(parts))]
    if len(blocks) < len(PARTS):
        raise ValueError(
            f"{place}: got {len(blocks)} blocks of about {block_rows} rows, expected at least "
            f"{len(PARTS)}; lower training.block_rows"
        )
    dealt: dict[str, list[Numbers]] = {part: [] for part in PARTS}
    for n, block in enumerate(blocks):
        dealt[PARTS[n % len(PARTS)]].append(block)
    return Split(**{part: np.concatenate(rows) for part, rows in dealt.items()})


def _halves(count: int, seed: int) -> Split:
    order = np.random.default_rng(seed).permutation(count)
    half, three_quarters = count // 2, count // 2 + count // 4
    return Split(order[:half], order[half:three_quarters], order[three_quarters:])
