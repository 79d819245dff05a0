"""``make sensors``: finds the best places of gauges on a beam."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder
from tactus.physics.gauges import OUTPUTS, GaugeRig, load_rig
from tactus.report.draw.svg import GROUPS, PLOT_INCHES, style, svg
from tactus.report.measure.table import Cell, Table

HEIGHT = 1.6  # inches of a panel


def gauges(rig: GaugeRig, sets: Mapping[str, Sequence[float]]) -> str:
    """The beam with the places of its gauges, and a panel for each output below."""
    with style():
        figure = Figure(
            figsize=(PLOT_INCHES[0], HEIGHT * (len(rig.outputs) + 1)), layout="constrained"
        )
        beam, *panels = figure.subplots(
            len(rig.outputs) + 1, 1, sharex=True, height_ratios=[1, *[2] * len(rig.outputs)]
        )
        beam.plot([0, 1e3 * rig.beam.length], [0, 0], color="black", linewidth=3)
        beam.plot([0, 0], [-1, len(sets) + 1], color="black", linewidth=6)
        beam.axvspan(
            1e3 * float(rig.placements.position.min()),
            1e3 * float(rig.placements.position.max()),
            color="#eeeeee",
        )
        for axes in (beam, *panels):
            axes.set_prop_cycle(GROUPS)
        for i, (label, places) in enumerate(sets.items()):
            beam.plot(
                [1e3 * place for place in places],
                [i + 0.8] * len(places),
                linestyle="none",
                label=label,
            )
            errors, at = rig.errors(places), rig.placements.position
            there = np.unique(at)
            for name, axes in zip(rig.outputs, panels, strict=True):
                column = errors[:, OUTPUTS.index(name)]
                means = [column[at == place].mean() for place in there]
                axes.plot(1e3 * there, means, markersize=3)
        beam.set_ylim(-1, len(sets) + 1)
        beam.set_yticks([])
        beam.set_ylabel("gauges")
        beam.grid(visible=False)
        for name, axes in zip(rig.outputs, panels, strict=True):
            axes.set_ylim(0, 1.1 * axes.dataLim.y1)
            axes.set_ylabel(f"{name}, bound %")
        panels[-1].set_xlabel("from the root, mm; grey: where loads lie")
        handles, labels = beam.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
        return svg(figure, "sensors", f"Places of gauges on {rig.name}, and their bounds")


COMPARED, FOUND = "compared", "best found"


def sensors(rig: GaugeRig) -> tuple[Table, str]:
    """The bounds for given places and for the best places, and their picture."""
    sets: dict[str, Sequence[float]] = {COMPARED: rig.compare} if rig.compare else {}
    sets[FOUND] = rig.best()
    rows: list[list[Cell]] = []
    for label, places in sets.items():
        errors, mm = rig.errors(places), ", ".join(f"{1e3 * place:.4g}" for place in places)
        for name in rig.outputs:
            column = errors[:, OUTPUTS.index(name)]
            rows.append([label, mm, name, float(column.mean()), float(column.max())])
    table = Table(
        "sensors",
        ["places", "mm from the root", "output", "mean %", "worst %"],
        rows,
        f"The figures are least mean errors for {len(rig.percent)} placements. They are the bound "
        "of Cramer and Rao with the prior knowledge that load, position and width lie in their "
        f"ranges. 'Best found' has the least {rig.objective} over placements and outputs.",
    )
    return table, gauges(rig, sets)


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
