"""The bounds for the best places of gauges on a beam."""

import math
from collections.abc import Sequence
from dataclasses import replace

from tactus.physics.gauge_places import Placing
from tactus.physics.gauge_rig import OUTPUTS, load_rig
from tactus.report.measure.table import Cell, Table

RIG = "digit"
FOUND = "best found"
COUNTS = (3, 4, 6)


def gauge_places(_: int) -> Table:
    """The bounds for few and for many gauges on the beam of the digit."""
    rig = load_rig(RIG)
    rows: list[list[Cell]] = []
    cases = [("thesis", rig, list(rig.compare))]
    for count in COUNTS:
        cases.append((FOUND, replace(rig, count=count), []))
    cases.append((FOUND, replace(rig, count=4, cell_noise=math.inf), []))
    for label, case, known in cases:
        placing = Placing(case)
        places = known or placing.best()
        means = placing.errors(places).mean(axis=0)
        cell = "yes" if math.isfinite(case.cell_noise) else "no"
        rows.append([label, len(places), cell, names_of(places), *map(float, means)])
    return Table(
        "gauge_places",
        ["places", "gauges", "load cell", "mm from the root", *(f"{n} %" for n in OUTPUTS)],
        rows,
        f"The figures are the least mean errors of rig {RIG} over loads, widths, shapes and "
        "positions, with prior knowledge of their ranges. The places are those of the recorded "
        "sensors 1 to 3, and the best that were found for as many gauges and for more. The load "
        "cell is sensor 4, which only reads the load.",
    )


def names_of(places: Sequence[float]) -> str:
    """Places in mm from the root."""
    return ", ".join(f"{1e3 * place:.4g}" for place in places)
