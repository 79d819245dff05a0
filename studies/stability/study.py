"""All stiff and extreme cases as one table."""

import math
from collections.abc import Callable, Iterator

from studies.stability import conditioned, functions, layered, networks, physics
from studies.stability.case import Row
from tactus.report.measure.table import Cell

# The fields in the order of the table.
CASES: tuple[Callable[[], Iterator[Row]], ...] = (
    *(networks.readings, networks.rails, networks.huge_weights, networks.accumulators),
    *(layered.rails, layered.ends, layered.dead, layered.ties, layered.ranges),
    *(functions.most_negative, functions.divergence, functions.narrow_loads, functions.jumps),
    *(physics.plates, physics.swings, physics.others),
    *(conditioned.networks, conditioned.recalibration, conditioned.learning),
)


def rows() -> Iterator[dict[str, Cell]]:
    """Every stiff and extreme case, with what must happen and its bound.

    Cases that differ in nothing but the model are one row, which names all of these models.
    """
    found: dict[tuple[Cell, ...], list[Row]] = {}
    for cases in CASES:
        for row in cases():
            key = (row.case, row.must, row.figure, row.value, row.bound)
            found.setdefault(key, []).append(row)
    for alike in found.values():
        row = alike[0]
        yield {
            "model": ", ".join(one.model for one in alike),
            "case": row.case,
            "must": row.must,
            "figure": row.figure,
            "value": row.value if math.isfinite(row.value) else None,
            "bound": row.bound,
            "holds": "yes" if row.holds else "no",
        }
