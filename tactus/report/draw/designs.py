"""Draws what every design of a scene's networks costs: LUTs against clocks."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from tactus.report.draw.named import Named, drawn
from tactus.report.draw.run_time import ACROSS, PRINTED, printed_designs
from tactus.scene import Scene
from tactus.sizing.candidates import Sized

TITLE = "LUTs against clocks"


def points(scene: Scene, rows: Sequence[Sized], family: str) -> list[Named]:
    """The designs of a scene, and those that the thesis prints for the digit, fewest LUTs first."""
    found = [
        Named(row.candidate.name, row.clocks, cells.size.luts)
        for row in rows
        if (cells := row.cells(family)) is not None
    ]
    if scene.reference in [key for key, _ in PRINTED.values()] and family == "xc2v":
        found += [Named(one.name, one.clocks, one.luts) for one in printed_designs()]
    return sorted(found, key=lambda one: (one.y, one.x, one.name))


def is_drawn(path: Path) -> bool:
    """Whether a file holds such a picture."""
    with suppress(OSError):
        return TITLE.encode() in path.read_bytes()
    return False


def picture_of(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    """Every design with its name; the front is drawn, and what it beats is grey."""
    found, said = points(scene, rows, family), sentence(scene, rows, family)
    title = f"{scene.name}: {TITLE}"
    return drawn(found, "designs", title, ACROSS, f"LUTs of {family}", said)


def sentence(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    """A sentence that says what the picture shows."""
    found = points(scene, rows, family)
    if not found:
        return "No design can be built."
    least, fastest = found[0], min(found, key=lambda one: (one.x, one.y))
    return (
        f"{least.name} is the smallest, with {least.y:,.0f} LUTs and {least.x:,.0f} "
        f"clocks; {fastest.name} is the fastest, with {fastest.y:,.0f} and {fastest.x:,.0f}."
    )
