"""``python -m tactus.report.measure.gauges RIG``: finds the best places of gauges on a beam."""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_folder
from tactus.core.folders import BUILD
from tactus.physics.gauge_places import Placing
from tactus.physics.gauge_rig import OUTPUTS, GaugeRig, load_rig
from tactus.report.draw.gauges import gauges
from tactus.report.measure.table import Cell, Table

RIG = "digit"
FOUND, COMPARED = "best found", "compared"
COUNTS = (3, 4, 6)


def sensors(rig: GaugeRig) -> tuple[Table, str]:
    """The bounds for given places and for the best places, and their picture."""
    placing = Placing(rig)
    sets: dict[str, Sequence[float]] = {COMPARED: rig.compare} if rig.compare else {}
    sets[FOUND] = placing.best()
    rows: list[list[Cell]] = []
    for label, places in sets.items():
        errors = placing.errors(places)
        for name in rig.outputs:
            column = errors[:, OUTPUTS.index(name)]
            rows.append([label, _names(places), name, float(column.mean()), float(column.max())])
    table = Table(
        "sensors",
        ["places", "mm from the root", "output", "mean %", "worst %"],
        rows,
        f"The figures are least mean errors for {len(rig.percent)} placements. They are the bound "
        "of Cramer and Rao with the prior knowledge that load, position and width lie in their "
        f"ranges. 'Best found' has the least {rig.objective} over placements and outputs.",
    )
    return table, gauges(placing, sets)


def sentence(table: Table) -> str:
    """A sentence on the gain of the best places, if there are others to compare with."""
    means = {(row[0], row[2]): float(str(row[3])) for row in table.rows}
    outputs = list(dict.fromkeys(str(row[2]) for row in table.rows))
    told = [
        f"{output} {means[COMPARED, output]:.2g} to {means[FOUND, output]:.2g} %"
        for output in outputs
        if (COMPARED, output) in means
    ]
    places = next(row[1] for row in table.rows if row[0] == FOUND)
    change = f" change the least mean errors: {', '.join(told)}" if told else " are the best found"
    return f"Gauges at {places} mm{change}. Only a gauge under a load feels its width."


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
        rows.append([label, len(places), cell, _names(places), *map(float, means)])
    return Table(
        "gauge_places",
        ["places", "gauges", "load cell", "mm from the root", *(f"{n} %" for n in OUTPUTS)],
        rows,
        f"The figures are the least mean errors of rig {RIG} over loads, widths, shapes and "
        "positions, with prior knowledge of their ranges. The places are those of the recorded "
        "sensors 1 to 3, and the best that were found for as many gauges and for more. The load "
        "cell is sensor 4, which only reads the load.",
    )


def _names(places: Sequence[float]) -> str:
    return ", ".join(f"{1e3 * place:.4g}" for place in places)


def main() -> None:
    parser = argparse.ArgumentParser(prog="make sensors", description=__doc__)
    parser.add_argument("rig")
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    rig = load_rig(arguments.rig)
    stop_if_dry_run(f"find where the gauges of {rig.name} should sit")
    table, picture = sensors(rig)
    print("\n".join(table.lines()))
    folder = arguments.build / "sensors" / rig.name
    with replace_folder(folder) as temporary:
        table.write_csv(temporary / "sensors.csv")
        (temporary / "sensors.svg").write_text(picture, encoding="utf-8")
    print(f"\nwrote {folder}")


if __name__ == "__main__":
    sys.exit(run(main))
