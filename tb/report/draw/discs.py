"""Discs that show what designs cost: LUTs against clocks, with a letter each and a legend below."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot

from golden.scene import load_scene, thesis_table
from tb.report.draw.axes import Axes
from tb.report.draw.drawing import ACCENT, INK, Point, dot, text

# The clocks of a scan of the thesis' front end, within which every network must finish.
SCAN_CLOCKS = 4096
COLOURS = {
    "engine": ACCENT,
    "lanes": "#7a3b8f",
    "hybrid": INK,
    "parallel": "#00807a",
    "adder_graph": "#1b7a3d",
    "table_graph": "#6b5a1e",
    "printed": "#b34700",
}
# The networks of the digit that the thesis prints with their share of its device, and our scenes of
# the same hidden nodes, design and arithmetic.
PRINTED = {
    "cascade": ("digit.cascade_b", "digit-thesis"),
    "single": ("digit.hybrid", "digit-single-thesis"),
}
ROW = 16.0
# The places of a letter around its disc, as parts of the distance that depends on its size.
_BESIDE = [(1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, -0.7), (0.7, 0.7)]
_BESIDE += [(-0.7, -0.7), (-0.7, 0.7), (1.9, 0.0), (-1.9, 0.0), (0.0, -1.9), (0.0, 1.9)]


@dataclass(frozen=True)
class Disc:
    """A design in a picture.

    kind: A name of ``COLOURS``.
    error: In per cent; 0 where the picture does not show it.
    """

    name: str
    kind: str
    luts: float
    multipliers: float
    clocks: float
    error: float = 0.0


def printed_discs() -> list[Disc]:
    """The networks that the thesis prints, at the clocks of ours of the same form.

    The thesis itself prints no time for a frame.
    """
    device, found = thesis_table("device"), []
    for name, (key, scene) in PRINTED.items():
        printed = thesis_table(key)
        luts = printed["luts_percent"] * device["luts4"] / 100
        multipliers = printed["mult18x18_percent"] * device["mult18x18"] / 100
        error = max(printed["simulation"])
        clocks = load_scene(scene).twin().output_clocks[-1]
        found.append(Disc(f"thesis, {name}", "printed", luts, multipliers, clocks, error))
    return found


def in_order(found: Sequence[Disc]) -> list[Disc]:
    """The design with the fewest LUTs first."""
    return sorted(found, key=lambda disc: (disc.luts, disc.clocks, disc.name))


def drawn(
    found: Sequence[Disc], sizes: Sequence[float], axes: Axes, columns: Mapping[str, float]
) -> tuple[list[str], float]:
    """The discs, their letters and the legend, and where the legend ends.

    sizes: The radius of each.
    columns: Where the columns of the legend end, by their names: of LUTs, multipliers and clocks.
    """
    body = []
    places = [axes.at(disc.clocks, disc.luts) for disc in found]
    letters = [chr(ord("a") + n) for n in range(len(found))]
    for disc, place, size in zip(found, places, sizes, strict=True):
        colour = COLOURS[disc.kind]
        body.append(dot(place, size, fill=colour, fill_opacity=0.35, stroke=colour))
    for letter, (x, y) in zip(letters, _beside(places, sizes, axes.left), strict=True):
        body.append(text((x, y + 4), letter, text_anchor="middle", font_weight="bold"))
    ends, y = list(columns.values()), axes.top + axes.height + 58
    body += _row(y, ends, list(columns))
    for letter, disc in zip(letters, found, strict=True):
        y += ROW
        body.append(text((6, y), letter, font_weight="bold"))
        body.append(text((24, y), disc.name, fill=COLOURS[disc.kind]))
        cells = [f"{cell:,.0f}" for cell in (disc.luts, disc.multipliers, disc.clocks)]
        body += _row(y, ends, cells)
    return body, y


def _row(y: float, ends: Sequence[float], cells: Sequence[str]) -> list[str]:
    return [text((x, y), cell, text_anchor="end") for x, cell in zip(ends, cells, strict=True)]


def _beside(places: Sequence[Point], sizes: Sequence[float], left: float) -> list[Point]:
    """A place for the letter of each disc, away from other discs, letters and the left axis."""
    found: list[Point] = []
    for (x, y), size in zip(places, sizes, strict=True):
        ways = [(x + (size + 8) * dx, y + (size + 8) * dy) for dx, dy in _BESIDE]

        def room(way: Point) -> float:
            discs = [
                hypot(way[0] - a, way[1] - b) - other
                for (a, b), other in zip(places, sizes, strict=True)
            ]
            letters = (hypot(way[0] - a, way[1] - b) - 6 for a, b in found)
            return min([7.0, way[0] - left, *discs, *letters])

        found.append(max(ways, key=room))
    return found
