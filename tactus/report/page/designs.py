"""The text and the picture of docs/designs.md."""

from functools import cache

from tactus.report.draw.designs import picture_of
from tactus.report.measure.designs import designs, refused_lines
from tactus.report.measure.table import cell_text, markdown
from tactus.scene import Scene, load_scene
from tactus.scene.building import compared
from tactus.sizing.candidates import Refused, Sized
from tactus.sizing.model import held_out

# The scenes of the page: the default one, one whose network every design of tanh neurons takes, and
# one of learned functions.
CASCADE, SINGLE, LEARNED = "digit", "digit-single", "comparison/digit-tables"


@cache
def _compared(name: str) -> tuple[Scene, list[Sized], list[Refused]]:
    scene = load_scene(name)
    return scene, *compared(scene)


def rows(name: str, family: str = "xc2v") -> str:
    """What each design of a scene costs, and those that cannot be built."""
    scene, found, refused = _compared(name)
    table = designs(scene, found, family)
    lines = ["", *(f"- {line}" for line in refused_lines(refused))] if refused else []
    cells = [["" if cell is None else cell_text(cell) for cell in row] for row in table.rows]
    return "\n".join([markdown(" | ".join(table.columns), cells), *lines])


def spreads() -> str:
    """Every recorded network, estimated by a model that does not know its weights."""
    rows = []
    for one in held_out():
        luts = [one.recorded.luts, f"{one.estimated.luts:.0f}", f"{one.percent:+.1f}"]
        rows.append([f"`{one.network}`", one.design, *luts])
    return markdown("network | design | LUTs | estimated | error %", rows)


def picture() -> str:
    """LUTs against clocks of the scene that every design of tanh neurons takes."""
    scene, found, _ = _compared(SINGLE)
    return picture_of(scene, found, "xc2v")
