"""All stiff and extreme cases as one table."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from tb.report.measure.stability import activations, layered, networks, physics, visualisation
from tb.report.measure.stability.case import Row
from tb.report.measure.table import Cell, Table

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
)


def stability(_: int) -> Table:
    """Every stiff and extreme case, with what must happen and its bound."""
    rows: list[list[Cell]] = [
        [
            row.model,
            row.case,
            row.must,
            row.figure,
            row.value if math.isfinite(row.value) else None,
            row.bound,
            "yes" if row.holds else "no",
        ]
        for cases in CASES
        for row in cases()
    ]
    return Table(
        "stability",
        ["model", "case", "must", "figure", "value", "bound", "holds"],
        rows,
        "Each case is run, on the bit-true twins wherever there is one. A value that is NaN or "
        "infinite is left out and breaks its bound. 'Codes off' are outputs that differ from the "
        "same sums in Python's integers, which have no width. Errors against real arithmetic are "
        "of tanh networks with the unrounded weights, which saturate where the formats do: of the "
        "output that comes nearest to its bound, which follows from the roundings and from the "
        "activation's largest error over every code. Networks of several layers are judged alike; "
        "where ranges of their words are from the data, the bound is for frames in which no sum "
        "saturates. D w is the deflection times the plate's stiffness.",
    )
