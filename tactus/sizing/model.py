"""Estimates LUTs and flip-flops of a network, from a model that is fitted to recorded syntheses.

The cells of a block, without those of its parts, are a sum of a few numbers that its twin knows
(``tactus.sizing.features``), each times a coefficient. ``cells.csv`` holds these numbers and the
cells that Yosys made of every block of the recorded networks; the coefficients are their least
squares. So a new record changes the estimates, and no coefficient stands anywhere by itself.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from golden.common.block import Block
from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.table import read_csv_file
from tactus.sizing.features import IN_ONE_PIECE, Features, Numbers, features_of, group_of

CELLS = Path(__file__).with_name("cells.csv")
COLUMNS: tuple[str, ...] = (
    "network",
    "weights",
    "design",
    "entity",
    "group",
    "count",
    "luts",
    "flip_flops",
    "luts_by",
    "flip_flops_by",
)


@dataclass(frozen=True)
class Recorded:
    """The own cells of one entity of a network that was synthesised.

    network: The scene, or the scene and the design that was made of its networks.
    weights: The first file of the network's weights; networks that share it are held out together.
    design: The design as ``tactus.sizing.candidates`` names it.
    entity, group: See ``group_of``.
    count: How often the network has the entity.
    luts, flip_flops: Cells of a Virtex-II, without those of the entity's parts.
    """

    network: str
    weights: str
    design: str
    entity: str
    group: str
    count: int
    luts: int
    flip_flops: int
    features: Features


@dataclass(frozen=True)
class Size:
    """Estimated cells."""

    luts: float
    flip_flops: float

    def __add__(self, other: Size) -> Size:
        return Size(self.luts + other.luts, self.flip_flops + other.flip_flops)

    def times(self, count: int) -> Size:
        """The cells of several equal entities."""
        return Size(count * self.luts, count * self.flip_flops)


NOTHING = Size(0, 0)
# For each group the coefficients of LUTs, and those of flip-flops.
Model = dict[str, tuple[Real, Real]]


@cache
def recorded() -> tuple[Recorded, ...]:
    """The rows of ``cells.csv``."""
    read = read_csv_file(CELLS)
    if tuple(read.names) != COLUMNS:
        raise InputError(f"{CELLS}: got columns {read.names}, expected {COLUMNS}")
    return tuple(
        Recorded(
            network,
            weights,
            design,
            entity,
            group,
            int(count),
            int(luts),
            int(flip_flops),
            Features(_numbers(luts_by), _numbers(flip_flops_by)),
        )
        for (
            network,
            weights,
            design,
            entity,
            group,
            count,
            luts,
            flip_flops,
            luts_by,
            flip_flops_by,
        ) in read.rows
    )


def _numbers(text: str) -> Numbers:
    return tuple(map(float, text.split()))


def fitted(rows: Iterable[Recorded]) -> Model:
    """The coefficients of each group, by least squares over different entities.

    An entity that several networks have counts once. Where there are fewer entities than numbers,
    the smallest coefficients that fit are taken.
    """
    luts: dict[str, set[tuple[Numbers, int]]] = {}
    flip_flops: dict[str, set[tuple[Numbers, int]]] = {}
    for row in rows:
        luts.setdefault(row.group, set()).add((row.features.luts, row.luts))
        flip_flops.setdefault(row.group, set()).add((row.features.flip_flops, row.flip_flops))
    return {group: (_least(luts[group]), _least(flip_flops[group])) for group in luts}


def _least(found: set[tuple[Numbers, int]]) -> Real:
    ordered = sorted(found)
    given = np.array([row[0] for row in ordered], dtype=float)
    coefficients: Real = np.linalg.lstsq(given, np.array([row[1] for row in ordered]), rcond=None)[
        0
    ]
    return coefficients


@cache
def model() -> Model:
    """The coefficients that fit all rows of ``cells.csv``."""
    return fitted(recorded())


def own_size(group: str, features: Features, known: Model) -> Size:
    """The estimated own cells of a block."""
    if group not in known:
        raise InputError(f"{group}: got a block that no recorded synthesis has")
    pairs = zip((features.luts, features.flip_flops), known[group], strict=True)
    return Size(*(max(0.0, float(np.dot(numbers, found))) for numbers, found in pairs))


def size_of(top: Block) -> Size:
    """The estimated cells of a network."""
    found = NOTHING
    for block, count in instances(top):
        found += own_size(group_of(block), features_of(block), model()).times(count)
    return found


def instances(top: Block) -> list[tuple[Block, int]]:
    """Every entity under ``top`` and itself, with the number of its instances.

    Where a network is synthesised in one piece, it is the only one.
    """
    if top.block in IN_ONE_PIECE:
        return [(top, 1)]
    counts: Counter[str] = Counter()
    blocks: dict[str, Block] = {}

    def visit(block: Block) -> None:
        blocks[block.entity] = block
        counts[block.entity] += 1
        for part in block.parts():
            visit(part)

    visit(top)
    return [(block, counts[entity]) for entity, block in blocks.items()]


@dataclass(frozen=True)
class Held:
    """A recorded network, and what the model says of it that was fitted to all others.

    luts, estimated: Recorded, and as the others would have it.
    """

    network: str
    design: str
    luts: int
    estimated: float

    @property
    def percent(self) -> float:
        """By how much the estimate is too large."""
        return 100 * (self.estimated / self.luts - 1)


@cache
def held_out() -> tuple[Held, ...]:
    """Every recorded network, estimated by a model that knows no network with its weights.

    A network is left out if it has something of which the others know nothing: a block, or a
    number that is 0 in all of theirs.
    """
    found = []
    for weights in sorted({row.weights for row in recorded()}):
        others = [row for row in recorded() if row.weights != weights]
        own = [row for row in recorded() if row.weights == weights]
        known, met = fitted(others), _met(others)
        for network in sorted({row.network for row in own}):
            rows = [row for row in own if row.network == network]
            if _met(rows) <= met:
                found.append(_held(rows, known))
    return tuple(found)


def _met(rows: Iterable[Recorded]) -> set[tuple[str, int]]:
    """The numbers that are not always 0, by group and index."""
    return {
        (row.group, index)
        for row in rows
        for index, number in enumerate(row.features.luts)
        if number
    }


def _held(rows: Collection[Recorded], known: Model) -> Held:
    first = next(iter(rows))
    estimated = sum(own_size(r.group, r.features, known).times(r.count).luts for r in rows)
    return Held(first.network, first.design, sum(r.luts * r.count for r in rows), estimated)


def spread(design: str) -> float | None:
    """The largest error of an estimate of LUTs in per cent, over networks that were held out.

    None if no network of the design can be held out.
    """
    found = [abs(one.percent) for one in held_out() if one.design == design]
    return max(found) if found else None
