"""Draws the cost of networks with four outputs: LUTs against clocks, with the error of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, sqrt

from golden.scene import thesis_table
from tb.report.draw.axes import Axes
from tb.report.draw.drawing import ACCENT, INK, Point, dot, picture, text
from tb.report.draw.findings import number, rows_of
from tb.report.measure.table import Table

# The clocks of a scan of the thesis' front end, within which its networks must finish.
SCAN_CLOCKS = 4096
WIDTH, ROW, COLUMNS = 400.0, 16.0, (206.0, 276.0, 328.0, 388.0)
COLOURS = {
    "engine": ACCENT,
    "lanes": "#7a3b8f",
    "hybrid": INK,
    "adder_graph": "#1b7a3d",
    "printed": "#b34700",
}
# In the line of kinds: the width of a letter, and what is between two kinds.
LETTER, GAP = 7.2, 20.0
# The places of a letter around its disc, as parts of the distance that depends on its size.
_BESIDE = [(1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, -0.7), (0.7, 0.7)]
_BESIDE += [(-0.7, -0.7), (-0.7, 0.7), (1.9, 0.0), (-1.9, 0.0), (0.0, -1.9), (0.0, 1.9)]


@dataclass(frozen=True)
class Disc:
    """A design in the picture."""

    name: str
    kind: str
    luts: float
    multipliers: float
    clocks: float
    error: float


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
    device = thesis_table("board")
    for name, key in (("cascade", "digit.cascade_b"), ("single", "digit.hybrid")):
        printed = thesis_table(key)
        luts = printed["luts_percent"] * device["luts4"] / 100
        multipliers = printed["mult18x18_percent"] * device["mult18x18"] / 100
        found.append(
            Disc(
                f"thesis, {name}",
                "printed",
                luts,
                multipliers,
                SCAN_CLOCKS,
                max(printed["simulation"]),
            )
        )
    return sorted(found, key=lambda design: (design.luts, design.clocks, design.name))


def area(table: Table) -> str:
    """A disc for each design, which is larger for a larger error, and a legend below."""
    found = designs(table)
    axes = Axes(46, 74, 334, 236, (6, 6000), (80, 12000))
    title = "The same four outputs: area, clocks, error"
    body = [text((6, 18), title, 13, font_weight="bold")]
    body += axes.drawn("clocks a frame", "Virtex-II LUTs; the larger a disc, the larger the error")
    places = [axes.at(design.clocks, design.luts) for design in found]
    sizes = [3 * sqrt(design.error) + 1 for design in found]
    letters = [chr(ord("a") + n) for n in range(len(found))]
    for design, place, size in zip(found, places, sizes, strict=True):
        colour = COLOURS[design.kind]
        body.append(dot(place, size, fill=colour, fill_opacity=0.35, stroke=colour))
    for letter, (x, y) in zip(letters, beside(places, sizes), strict=True):
        body.append(text((x, y + 4), letter, text_anchor="middle", font_weight="bold"))
    top = axes.top + axes.height + 58
    heads = ("LUTs", "multipliers", "clocks", "error %")
    body += _row(top, heads)
    left = 6.0
    for kind, colour in COLOURS.items():
        body.append(text((left, 38), kind, fill=colour, font_weight="bold"))
        left += LETTER * len(kind) + GAP
    for n, (letter, design) in enumerate(zip(letters, found, strict=True), 1):
        y = top + n * ROW
        body.append(text((6, y), letter, font_weight="bold"))
        body.append(text((20, y), design.name, fill=COLOURS[design.kind]))
        cells = (design.luts, design.multipliers, design.clocks)
        body += _row(y, [*(f"{cell:,.0f}" for cell in cells), f"{design.error:.2f}"])
    return picture(
        f"{title}. {sentence(table)}", (WIDTH, top + ROW * len(found) + 12), body, widest=560
    )


def sentence(table: Table) -> str:
    """A sentence that says what the picture shows."""
    found = designs(table)
    least, most = found[0], max(found, key=lambda design: (design.luts, design.clocks))
    return (
        f"{least.name} takes {least.luts:,.0f} LUTs and {least.clocks:,.0f} clocks, {most.name} "
        f"{most.luts:,.0f} and {most.clocks:,.0f}; a scan of the sensors takes {SCAN_CLOCKS:,}. "
        "The thesis is shown at the clocks of its scan."
    )


def _row(y: float, cells: Sequence[str]) -> list[str]:
    return [text((x, y), cell, text_anchor="end") for x, cell in zip(COLUMNS, cells, strict=True)]


def beside(places: Sequence[Point], sizes: Sequence[float]) -> list[Point]:
    """A place for the letter of each disc, away from other discs and letters."""
    found: list[Point] = []
    for (x, y), size in zip(places, sizes, strict=True):
        ways = [(x + (size + 8) * dx, y + (size + 8) * dy) for dx, dy in _BESIDE]

        def room(way: Point) -> float:
            discs = [
                hypot(way[0] - a, way[1] - b) - other
                for (a, b), other in zip(places, sizes, strict=True)
            ]
            return min([7.0, *discs, *(hypot(way[0] - a, way[1] - b) - 6 for a, b in found)])

        found.append(max(ways, key=room))
    return found
