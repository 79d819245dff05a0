"""Draws what every design of a scene's networks costs: LUTs against clocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

from golden.scene import Scene, thesis_table
from golden.sizing.candidates import Sized
from tb.report.draw.area import SCAN_CLOCKS, beside
from tb.report.draw.axes import Axes
from tb.report.draw.drawing import ACCENT, INK, dot, picture, text

WIDTH, ROW, COLUMNS = 480.0, 16.0, (340.0, 410.0, 466.0)
RADIUS = 5.0
COLOURS = {
    "engine": ACCENT,
    "hybrid": INK,
    "parallel": "#8a3d8f",
    "adder_graph": "#1b7a3d",
    "printed": "#b34700",
}
OTHER = "#00807a"
# The networks of the digit that the thesis prints with their share of its device.
PRINTED = {"cascade": "digit.cascade_b", "single": "digit.hybrid"}


@dataclass(frozen=True)
class Spot:
    """A design in the picture."""

    name: str
    kind: str
    luts: float
    multipliers: float
    clocks: float

    @property
    def colour(self) -> str:
        """The colour of its design."""
        return COLOURS.get(self.kind, OTHER)


def spots(scene: Scene, rows: Sequence[Sized], family: str) -> list[Spot]:
    """The designs of a scene, and those that the thesis prints for the digit, fewest LUTs first."""
    found = []
    for row in rows:
        cells = row.cells(family)
        if cells is not None:
            luts = cells.size.luts
            name, kind = row.candidate.name, row.candidate.design
            found.append(Spot(name, kind, luts, cells.multipliers, row.clocks))
    if scene.reference in PRINTED.values() and family == "xc2v":
        device = thesis_table("board")
        for name, key in PRINTED.items():
            printed = thesis_table(key)
            luts = printed["luts_percent"] * device["luts4"] / 100
            multipliers = printed["mult18x18_percent"] * device["mult18x18"] / 100
            found.append(Spot(f"thesis, {name}", "printed", luts, multipliers, SCAN_CLOCKS))
    return sorted(found, key=lambda spot: (spot.luts, spot.clocks, spot.name))


def picture_of(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    """A disc for each design, and a legend below."""
    found = spots(scene, rows, family)
    title = f"{scene.name}: LUTs against clocks"
    clocks = _decades([spot.clocks for spot in found])
    axes = Axes(52, 48, 410, 240, clocks, _decades([spot.luts for spot in found]))
    body = [text((6, 18), title, 13, font_weight="bold")]
    body += axes.drawn("clocks from the last sample to the last output", f"LUTs of {family}")
    letters = [chr(ord("a") + n) for n in range(len(found))]
    places = [axes.at(spot.clocks, spot.luts) for spot in found]
    for place, spot in zip(places, found, strict=True):
        body.append(dot(place, RADIUS, fill=spot.colour, fill_opacity=0.45, stroke=spot.colour))
    beyond = beside(places, [RADIUS] * len(places))
    for letter, (x, y) in zip(letters, beyond, strict=True):
        body.append(text((x, y + 4), letter, text_anchor="middle", font_weight="bold"))
    top = axes.top + axes.height + 56
    body += _row(top, ("LUTs", "multipliers", "clocks"))
    for n, (letter, spot) in enumerate(zip(letters, found, strict=True), 1):
        y = top + n * ROW
        body.append(text((6, y), letter, font_weight="bold"))
        body.append(text((20, y), spot.name, fill=spot.colour))
        cells = (spot.luts, spot.multipliers, spot.clocks)
        body += _row(y, [f"{cell:,.0f}" for cell in cells])
    height = top + ROW * len(found) + 12
    return picture(f"{title}. {sentence(scene, rows, family)}", (WIDTH, height), body, widest=640)


def sentence(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    """A sentence that says what the picture shows."""
    found = spots(scene, rows, family)
    if not found:
        return "No design can be built."
    least, fastest = found[0], min(found, key=lambda spot: (spot.clocks, spot.luts))
    return (
        f"{least.name} is the smallest, with {least.luts:,.0f} LUTs and {least.clocks:,.0f} "
        f"clocks; {fastest.name} is the fastest, with {fastest.luts:,.0f} and "
        f"{fastest.clocks:,.0f}."
    )


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """The powers of ten around values above 0."""
    low = floor(log10(min(values, default=1)))
    return 10.0**low, 10.0 ** max(low + 1, ceil(log10(max(values, default=10))))


def _row(y: float, cells: Sequence[str]) -> list[str]:
    return [text((x, y), cell, text_anchor="end") for x, cell in zip(COLUMNS, cells, strict=True)]
