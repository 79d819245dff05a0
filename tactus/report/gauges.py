"""``python -m tactus.report.gauges RIG``: finds the best places of gauges on a beam."""

import sys
from collections.abc import Sequence

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder
from tactus.physics.gauge_places import Placing
from tactus.physics.gauge_rig import OUTPUTS, GaugeRig, load_rig
from tactus.report.draw.gauges import gauges
from tactus.report.measure.gauges import FOUND, names_of
from tactus.report.measure.table import Cell, Table

COMPARED = "compared"


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
            rows.append([label, names_of(places), name, float(column.mean()), float(column.max())])
    table = Table(
        "sensors",
        ["places", "mm from the root", "output", "mean %", "worst %"],
        rows,
        f"The figures are least mean errors for {len(rig.percent)} placements. They are the bound "
        "of Cramer and Rao with the prior knowledge that load, position and width lie in their "
        f"ranges. 'Best found' has the least {rig.objective} over placements and outputs.",
    )
    return table, gauges(placing, sets)


def main() -> None:
    arguments = arguments_of("sensors", __doc__)
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
