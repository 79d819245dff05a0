"""The rows that train a network, those that choose it, and those that are kept out of both."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.table import read_groups, rows_where
from tactus.scene import Scene
from tactus.scene.scale import AUTO, range_scale
from tactus.scene.vectors import read_recorded

Numbers = NDArray[np.int64]

# Half of the blocks train, a quarter chooses and a quarter tests. Of any two neighbours one trains.
PARTS = ("training", "validation", "training", "test")


@dataclass(frozen=True)
class Split:
    """Row numbers of the training, validation and test rows: about 50, 25 and 25 % of all."""

    training: Numbers
    validation: Numbers
    test: Numbers

    def rows(self, part: str, every: int) -> Numbers:
        """The rows of a part; "known" are those that train or choose, and "every" counts all."""
        if part == "every":
            return np.arange(every)
        known = np.concatenate([self.training, self.validation])
        rows: Numbers = known if part == "known" else getattr(self, part)
        return rows

    @property
    def count(self) -> int:
        return sum(map(len, (self.training, self.validation, self.test)))


def split_of(scene: Scene) -> Split:
    """The split that ``training.split`` of a scene requests."""
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

    In every stretch of one part these are the first rows, as many as the past is long, unless a
    recording begins there.

    runs, shape (rows,): The recording of each row, as a number.
    past: How many rows a row reaches back.
    place: The beginning of a message.
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
    """The part of a network's provenance that determines its split: data, rows and settings."""
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
    """A text about recorded rows that are not used because of past samples; else empty."""
    if scene.window.plain:
        return ""
    without = read_recorded(scene).without_past
    border = len(scene.vectors().codes) - split_of(scene).count
    return (
        f"{without} further rows have no whole past and are not used; {border} share samples with "
        "rows of another part of the split and are in none"
    )


def _columns(scene: Scene) -> tuple[Numbers, Real]:
    """The recording of each row that the scene uses, and the columns of ``training.split_by``."""
    found = []
    for path in scene.data_paths:
        kept = rows_where(path, scene.where)[scene.window.past :]
        found.append(read_groups(path, scene.training.split_by)[kept])
    return np.repeat(np.arange(len(found)), [len(one) for one in found]), np.concatenate(found)


def split_rows(rows: int, seed: int, place: str = "rows") -> Split:
    if rows < 8:
        raise InputError(f"{place}: got {rows} rows, expected at least 8 to split in 50, 25, 25 %")
    return _halves(rows, seed)


def split_groups(values: Real, seed: int, place: str = "groups") -> Split:
    """Split groups of rows at random; rows with the same ``values`` stay together.

    With two or three groups, one is the test rows as a whole, and two thirds of the rows of the
    others train.

    values: shape (rows, columns).
    place: The beginning of a message.
    """
    groups, member = np.unique(values, axis=0, return_inverse=True)
    if len(groups) < 2:
        raise InputError(
            f"{place}: got {len(groups)} groups of rows with the same training.split_by, expected "
            "at least 2, of which one is held out"
        )
    if len(groups) < 4:
        rng = np.random.default_rng(seed)
        unseen = member.ravel() == rng.integers(len(groups))
        seen = rng.permutation(np.flatnonzero(~unseen))
        training = -(-2 * len(seen) // 3)
        return Split(seen[:training], seen[training:], np.flatnonzero(unseen))
    chosen = _halves(len(groups), seed)
    return Split(
        *(
            np.flatnonzero(np.isin(member.ravel(), part))
            for part in (chosen.training, chosen.validation, chosen.test)
        )
    )


def split_blocks(values: Real, block_rows: int, seed: int, place: str = "blocks") -> Split:
    """Split stretches of rows; rows that follow each other in the file stay together.

    A run is a stretch in which ``values`` do not change; without ``values`` it is the whole file.
    It is cut into equal blocks of about ``block_rows`` rows. The blocks of a run, in random order,
    and then those of the next run, are dealt out to ``PARTS`` in turn. So every run of two or more
    blocks has one that trains.

    values: shape (rows, columns).
    place: The beginning of a message.
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


def scaled(scene: Scene) -> Scene:
    """The scene with a scale in the place of every "auto".

    The scale of a sensor comes from the rows that train, because nothing about the other rows is
    known beforehand. The scale of an output comes from all rows, because its range is required and
    not learnt. Sensors that a converter reads have the scale of its data sheet.
    """
    wanted = scene.auto
    kept = {n: s for n, s in scene.scale.items() if s != AUTO or n in wanted}
    known = kept | scene.converter_scales
    if not wanted:
        return scene if known == scene.scale else replace(scene, scale=known)
    rows = read_recorded(scene)
    training = split_of(scene).training
    columns = dict(zip(scene.sensors, rows.sensors[training].T, strict=True))
    columns |= dict(zip(scene.outputs, rows.targets.T, strict=True))
    found = known
    for name in wanted:
        try:
            found[name] = range_scale(columns[name])
        except InputError as error:
            raise InputError(
                f"{scene.data_text}: column {name!r}: {error}, for data.scale.{name} in "
                f"{scene.path}"
            ) from None
    return replace(scene, scale=found)
