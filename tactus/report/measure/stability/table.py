"""All stiff and extreme cases as one table."""

import math
from collections.abc import Callable, Iterator

from tactus.report.measure.stability import (
    activations,
    conditioned,
    layered,
    networks,
    physics,
    visualisation,
)
from tactus.report.measure.stability.case import Row
from tactus.report.measure.table import Cell, Table

# The fields in the order of the table.
CASES: tuple[Callable[[], Iterator[Row]], ...] = (
    networks.readings,
    networks.rails,
    networks.huge_weights,
    networks.accumulators,
    layered.layered,
    activations.most_negative,
    activations.divergence,
    visualisation.narrow_loads,
    visualisation.jumps,
    physics.plates,
    physics.swings,
    physics.others,
    conditioned.conditioned,
)

NOTES = {
    "stability": "Each case is run, on bit-true twins wherever there are any. A value that is NaN "
    "or infinite breaks its bound, and its cell is empty. 'Codes off' counts the outputs that "
    "differ from the same sums in Python's integers, which have no width. Errors against real "
    "arithmetic compare with a tanh network that has the unrounded weights and saturates where the "
    "formats do. They are shown for the output that comes nearest to its bound. This bound follows "
    "from the roundings and from the largest error of the activation over every code. Networks of "
    "several layers are judged in the same way. If the ranges of their words come from the data, "
    "the bound is for frames in which no sum saturates. Cases that "
    "differ in nothing but the model are one row.",
}


def stability(_: int) -> Table:
    """Every stiff and extreme case, with what must happen and its bound.

    Cases that differ in nothing but the model are one row, which names all of these models.
    """
    found: dict[tuple[Cell, ...], list[Row]] = {}
    for cases in CASES:
        for row in cases():
            key = (row.case, row.must, row.figure, row.value, row.bound)
            found.setdefault(key, []).append(row)
    rows: list[list[Cell]] = [
        [
            ", ".join(one.model for one in alike),
            row.case,
            row.must,
            row.figure,
            row.value if math.isfinite(row.value) else None,
            row.bound,
            "yes" if row.holds else "no",
        ]
        for alike in found.values()
        for row in alike[:1]
    ]
    return Table(
        "stability",
        ["model", "case", "must", "figure", "value", "bound", "holds"],
        rows,
        NOTES["stability"],
    )
