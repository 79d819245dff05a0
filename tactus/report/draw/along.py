"""Draws errors of several networks along the beam, and errors for each width."""

from matplotlib.figure import Figure

from tactus.report.draw.findings import groups, number, rows_of
from tactus.report.draw.looks import nth
from tactus.report.draw.plot import plotted
from tactus.report.draw.plots import Plot
from tactus.report.draw.svg import style
from tactus.report.measure.table import Table

INCHES = (7.2, 5.6)
PLACE, MEAN, LEAST, MOST = "mm from the tip", "mean %", "least %", "largest %"


def name_of(arithmetic: str) -> str:
    """The file name of the picture, without its suffix."""
    return f"along_{arithmetic.replace('-', '_').replace(' ', '_')}"


def along_beam(table: Table, arithmetic: str) -> str:
    """A panel for each output, with a line in a band for each network.

    The line is the mean error at a position. The band reaches from the least to the largest.

    table: The table ``along_beam``.
    arithmetic: Which rows of the table are drawn.
    """
    rows = rows_of(table, arithmetic=arithmetic)
    outputs = list(dict.fromkeys(str(row["output"]) for row in rows))
    networks = list(dict.fromkeys(str(row["network"]) for row in rows))
    with style():
        figure = Figure(figsize=INCHES, layout="constrained")
        panels = figure.subplots(2, 2, sharex=True)
        for output, axes in zip(outputs, panels.flat, strict=True):
            for i, network in enumerate(networks):
                own = rows_of(table, arithmetic=arithmetic, output=output, network=network)
                place, mean, least, most = (
                    [number(row, column) for row in own] for column in (PLACE, MEAN, LEAST, MOST)
                )
                look = nth(i)
                axes.fill_between(place, least, most, color=look.colour, alpha=0.18, linewidth=0)
                axes.plot(
                    place, mean, color=look.colour, marker=look.marker, markersize=3, label=network
                )
            axes.set_ylim(bottom=0)
            axes.set_title(output, fontsize=10)
            axes.set_ylabel("error %")
        for axes in panels[1]:
            axes.set_xlabel(PLACE)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(networks))
        title = f"Error along the beam, {arithmetic}: {', '.join(networks)}; mean and spread"
        return plotted(figure, name_of(arithmetic), title)


def along_sentence(table: Table, arithmetic: str) -> str:
    """A sentence on the least mean error of each output, and its largest single error."""
    least, largest = [], []
    for output in dict.fromkeys(row["output"] for row in rows_of(table, arithmetic=arithmetic)):
        rows = rows_of(table, arithmetic=arithmetic, output=output)
        places = list(dict.fromkeys(row[PLACE] for row in rows))
        wins = [
            min((row for row in rows if row[PLACE] == place), key=lambda row: number(row, MEAN))[
                "network"
            ]
            for place in places
        ]
        network = max(dict.fromkeys(wins), key=wins.count)
        least.append(f"{network} for {output} ({wins.count(network)} of {len(places)})")
        worst = max(rows, key=lambda row: number(row, MOST))
        largest.append(f"{number(worst, MOST):.1f} % of {output} ({worst['network']})")
    return (
        f"These networks have the smallest mean error at most positions: {', '.join(least)}. The "
        f"largest errors of a single row are {', '.join(largest)}."
    )


def widths_plot(table: Table) -> Plot:
    """The error of the width, in percent of the width, against the width."""
    rows = rows_of(table)
    found = groups(rows, lambda row: str(row["network"]), "width mm", "mean %")
    told = [
        f"{network} {points[0][1]:.1f} % of {points[0][0]:g} mm and {points[-1][1]:.1f} % of "
        f"{points[-1][0]:g} mm"
        for network, points in found.items()
    ]
    return Plot(
        "widths",
        "Error of the width against the width",
        "width of the load, mm",
        "mean error, % of that width",
        found,
        f"The mean errors of the width: {'; '.join(told)}.",
        [table.name],
        linear="x",
    )
