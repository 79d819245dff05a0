"""Draws what every design of a scene's networks costs: LUTs against clocks."""

from collections.abc import Sequence
from contextlib import suppress
from math import ceil, floor, log10
from pathlib import Path

from tactus.report.draw.drawing import picture, text
from tactus.report.draw.named import Axes, Named, drawn
from tactus.report.draw.run_time import PRINTED, Disc, in_order, printed_discs
from tactus.scene import Scene
from tactus.sizing.candidates import Sized

TITLE = "LUTs against clocks"


def spots(scene: Scene, rows: Sequence[Sized], family: str) -> list[Disc]:
    """The designs of a scene, and those that the thesis prints for the digit, fewest LUTs first."""
    found = [
        Disc(
            row.candidate.name,
            cells.size.luts,
            cells.multipliers,
            row.clocks,
        )
        for row in rows
        if (cells := row.cells(family)) is not None
    ]
    if scene.reference in [key for key, _ in PRINTED.values()] and family == "xc2v":
        found += printed_discs()
    return in_order(found)


def is_drawn(path: Path) -> bool:
    """Whether a file holds such a picture."""
    with suppress(OSError):
        return TITLE.encode() in path.read_bytes()
    return False


def picture_of(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    """Every design with its name; the front is drawn, and what it beats is grey."""
    found = spots(scene, rows, family)
    title = f"{scene.name}: {TITLE}"
    clocks = _decades([spot.clocks for spot in found])
    axes = Axes(52, 48, 640, 400, clocks, _decades([spot.luts for spot in found]))
    body = [text((6, 18), title, 13, font_weight="bold")]
    body += axes.drawn("clocks from the last sample to the last output", f"LUTs of {family}")
    points = [Named(spot.name, spot.clocks, spot.luts) for spot in found]
    said = f"{title}. {sentence(scene, rows, family)}"
    return picture(said, (720, 490), [*body, *drawn(points, axes)], 560, 860)


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
