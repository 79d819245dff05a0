"""Draws the cost of networks with four outputs: LUTs against clocks, with the error of each."""

from __future__ import annotations

from math import sqrt

from tb.report.draw.axes import Axes
from tb.report.draw.discs import COLOURS, SCAN_CLOCKS, Disc, drawn, in_order, printed_discs
from tb.report.draw.drawing import picture, text
from tb.report.draw.findings import number, rows_of
from tb.report.measure.table import Table

WIDTH = 400.0
COLUMNS = {"LUTs": 206.0, "multipliers": 276.0, "clocks": 328.0, "error %": 388.0}
# In the line of kinds: the width of a letter, and what is between two kinds.
LETTER, GAP = 7.0, 9.0


def designs(table: Table) -> list[Disc]:
    """The networks of four outputs that finish within a scan, and the printed ones.

    The network with the fewest LUTs comes first. Scenes with a front end are left out, because they
    are not networks alone and wait for their scan.
    """
    found = [
        Disc(
            str(row["scene"]).removeprefix("comparison/"),
            str(row["design"]),
            number(row, "LUT"),
            number(row, "multiplier"),
            number(row, "clocks a frame"),
            number(row, "largest %"),
        )
        for row in rows_of(table, data="appendix2", outputs=4)
        if row["LUT"] is not None and number(row, "interval clocks") < SCAN_CLOCKS
    ]
    return in_order([*found, *printed_discs()])


def area(table: Table) -> str:
    """A disc for each design, which is larger for a larger error, and a legend below."""
    found = designs(table)
    axes = Axes(46, 74, 334, 236, (6, 6000), (80, 12000))
    title = "The same four outputs: area, clocks, error"
    body = [text((6, 18), title, 13, font_weight="bold")]
    left, kinds = 6.0, {disc.kind for disc in found}
    for kind in (kind for kind in COLOURS if kind in kinds):
        body.append(text((left, 38), kind, fill=COLOURS[kind], font_weight="bold"))
        left += LETTER * len(kind) + GAP
    body += axes.drawn("clocks a frame", "Virtex-II LUTs; the larger a disc, the larger the error")
    sizes = [3 * sqrt(design.error) + 1 for design in found]
    discs, bottom = drawn(found, sizes, axes, COLUMNS)
    said = f"{title}. {sentence(table)}"
    return picture(said, (WIDTH, bottom + 12), [*body, *discs], widest=560)


def sentence(table: Table) -> str:
    """A sentence that says what the picture shows."""
    found = designs(table)
    least, most = found[0], max(found, key=lambda design: (design.luts, design.clocks))
    return (
        f"{least.name} takes {least.luts:,.0f} LUTs and {least.clocks:,.0f} clocks, {most.name} "
        f"{most.luts:,.0f} and {most.clocks:,.0f}; a scan of the sensors takes {SCAN_CLOCKS:,}. "
        "The thesis is shown at the clocks of its scan."
    )
