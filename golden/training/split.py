"""Which rows train a network, which choose it, and which are kept out of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.real import Real
from golden.scene.vectors import read_recorded
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

    @property
    def count(self) -> int:
        """Rows in any part."""
        return sum(map(len, (self.training, self.validation, self.test)))


def split_of(scene: Scene) -> Split:
    """The split that ``training.split`` of a scene names.

    Raises
    ------
    InputError
        For too few rows, blocks or groups, or a column of ``training.split_by`` that is not there.
    """
    settings = scene.training
    runs, values = _columns(scene)
    place = f"{scene.data_text}: training.split of {scene.path}"
    if settings.split == "random":
        return split_rows(len(values), settings.seed, place)
    if settings.split == "groups":
        split = split_groups(values, settings.seed, place)
    else:
        stretches = np.column_stack([runs, values])
        split = split_blocks(stretches, settings.block_rows, settings.seed, place)
    return apart(split, runs, scene.window.past, place)


def apart(split: Split, runs: Numbers, past: int, place: str = "rows") -> Split:
    """A split without the rows that share a sample with a row of another part.

    Of every stretch of one part those are its first rows, as many as the past is long, unless a
    recording begins there.

    Parameters
    ----------
    split : Split
    runs : int array, shape (rows,)
        Which recording each row is of.
    past : int
        Rows that a row reaches back.
    place : str
        What a message names.

    Raises
    ------
    InputError
        When nothing is left of a part.
    """
    parts = {name: getattr(split, name) for name in ("training", "validation", "test")}
    part = np.zeros(len(runs), dtype=np.int64)
    for number, rows in enumerate(parts.values()):
        part[rows] = number
    rows = np.arange(len(runs))
    recording = np.append(True, runs[1:] != runs[:-1])
    border = np.append(False, part[1:] != part[:-1]) & ~recording
    since = rows - np.maximum.accumulate(np.where(border | recording, rows, 0))
    begun = border[rows - since]
    kept = {name: found[~(begun & (since < past))[found]] for name, found in parts.items()}
    for name, found in kept.items():
        if not len(found):
            raise InputError(
                f"{place}: got no {name} rows that share none of their samples with rows of other "
                f"parts, expected stretches of more than {past} rows, which data.window reaches "
                "back"
            )
    return Split(**kept)


def split_story(scene: Scene) -> dict[str, str | int]:
    """What the provenance of a network says of the rows: whoever reads the same has this split."""
    settings = scene.training
    return {
        "data": ", ".join(path.name for path in scene.data_paths),
        **({} if scene.window.plain else {"window": scene.window_text}),
        "rows": len(scene.vectors().codes),
        "seed": settings.seed,
        "split": settings.split,
        "split_by": ", ".join(settings.split_by),
        "block_rows": settings.block_rows if settings.split == "blocks" else 0,
    }


def unused_text(scene: Scene) -> str:
    """Which recorded rows are not used, where networks see past samples; nothing elsewhere."""
    if scene.window.plain:
        return ""
    without = read_recorded(scene).without_past
    border = len(scene.vectors().codes) - split_of(scene).count
    return (
        f"{without} further rows have no whole past and are not used; {border} share samples with "
        "rows of another part of the split and are in none"
    )


def _columns(scene: Scene) -> tuple[Numbers, Real]:
    """Of the rows that the scene uses: the recording, and the columns of ``training.split_by``."""
    found = []
    for path in scene.data_paths:
        kept = rows_where(path, scene.where)[scene.window.past :]
        found.append(read_table(path, scene.training.split_by)[kept])
    return np.repeat(np.arange(len(found)), [len(one) for one in found]), np.concatenate(found)


def split_rows(rows: int, seed: int, place: str = "rows") -> Split:
    """A random split of ``rows`` rows.

    Raises
    ------
    InputError
        For fewer than 8 rows: a part would hold a single row or none.
    """
    if rows < 8:
        raise InputError(f"{place}: got {rows} rows, expected at least 8 to split in 50, 25, 25 %")
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
    InputError
        For fewer than 4 groups: a part would have none.
    """
    groups, member = np.unique(values, axis=0, return_inverse=True)
    if len(groups) < 4:
        raise InputError(
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
    InputError
        For fewer than 4 blocks: a part would have none.
    """
    borders = np.flatnonzero((values[1:] != values[:-1]).any(axis=1)) + 1
    rng = np.random.default_rng(seed)
    blocks: list[Numbers] = []
    for run in np.split(np.arange(len(values)), borders):
        parts = np.array_split(run, max(1, round(len(run) / block_rows)))
        blocks += [parts[n] for n in rng.permutation(len(parts))]
    if len(blocks) < len(PARTS):
        raise InputError(
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
