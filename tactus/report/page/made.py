"""What programs know, for the pages of the site that ask for it with ``<!-- made: name -->``.

It is written when the site is built and committed nowhere, so it cannot be out of date.
"""

import re
import tomllib
from collections.abc import Callable
from fractions import Fraction
from functools import cache, partial
from itertools import zip_longest

import numpy as np

from golden.activation.schemes import forms
from golden.activation.segments import GRADIENT, INTERCEPT, UPPER
from golden.engine.pipeline import Pipeline
from golden.sensing.converter_parts import PARTS
from tactus.boards import board_names, load_board
from tactus.boards.bitstream import Report, read_record, record_path
from tactus.core.fingerprint import ROOT
from tactus.core.schema import key_rows
from tactus.errors import decisions_of, held_out_or_all
from tactus.report.activations import activation_table, plot
from tactus.report.designs import designs, picture_of, refused_lines
from tactus.report.draw.load import load_profile
from tactus.report.draw.network import network
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import Table, cell_text, markdown
from tactus.report.page import blocks, sign_off
from tactus.report.page.headline import headline
from tactus.scene import Scene, class_names, load_scene, scene_names, thesis_table
from tactus.scene.building import compared
from tactus.scene.keys import SCENE
from tactus.sizing.candidates import Refused, Sized
from tactus.sizing.model import held_out
from tactus.synth.budget import read_budget

ROOMS = ("golden", "hdl", "tb", "tactus")


def scenes() -> str:
    """Every shipped scene, with the first paragraph of its file and its parts."""
    rows = []
    for name in sorted([*scene_names(), *class_names()]):
        scene = load_scene(name)
        head = re.split(r"\n#?\n", scene.path.read_text(encoding="utf-8"), maxsplit=1)[0]
        text = " ".join(line.removeprefix("#").strip() for line in head.splitlines())
        parts = scene.design, scene.activation, scene.precision.name
        rows.append([f"`{name}`", text, *(f"`{word}`" for word in parts)])
    return markdown("shipped scene | what it is | design | activation | precision", rows)


def classes() -> str:
    """What every shipped scene of classes costs, and how often it is wrong on held-out rows."""
    heads = (
        "scene | network | LUT | multiplier | block RAM | clocks of a frame | held-out rows | "
        "wrong | wrong in floating point"
    )
    table = []
    for name in class_names():
        scene = load_scene(name)
        top = read_budget(scene.path)["xc2v"][scene.twin().entity]
        held_out, _ = held_out_or_all(scene, decisions_of(scene))
        rows = len(held_out.actual)
        cells = [
            f"`{name}`",
            scene.describe(),
            *(top[kind] for kind in ("LUT", "multiplier", "block RAM")),
            clocks_per_frame(scene.twin()),
            rows,
            rows - held_out.right,
            rows - held_out.right_real,
        ]
        table.append(cells)
    return markdown(heads, table)


def keys(section: str) -> str:
    return key_rows(SCENE["properties"][section])


def floors() -> str:
    """The packages of the four rooms, from the top floor down: contracts of import-linter."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    rooms = [
        [", ".join(f"`{one}`" for one in layer.split(" | ")) for layer in contract["layers"][::-1]]
        for room in ROOMS
        for contract in contracts
        if contract.get("containers") == [room]
    ]
    rows = [*zip_longest(*rooms, fillvalue="")][::-1]
    return markdown(" | ".join(f"{room}/" for room in ROOMS), rows)


def segments() -> str:
    rows = zip(range(1, len(UPPER) + 1), UPPER, GRADIENT, INTERCEPT, strict=True)
    return markdown("n | up to q_n | g_n | i_n", rows)


def pipeline() -> str:
    """Every clock of an engine's pipeline, and what happens in it."""
    rows = []
    forms = [Pipeline(), Pipeline(memory_registers=1)]
    for name, value in vars(Pipeline).items():
        if isinstance(value, property):
            clocks = [getattr(form, name) for form in forms]
            rows.append([f"`{name}`", *clocks, " ".join((value.__doc__ or "").split())])
    return markdown("name | clocks | with registers | what is there", rows)


def as_page(table: Table) -> str:
    return f"{markdown(' | '.join(table.columns), table.shown)}\n\n{table.note}"


def picture(draw: Callable[[], str]) -> str:
    """An SVG within the page, which scrolls sideways where the page is narrow."""
    return f'<div style="overflow-x:auto">\n{draw().strip()}\n</div>'


# The scenes of docs/designs.md: the default one, one whose network every design of tanh neurons
# takes, and one of learned functions.
CASCADE, SINGLE, LEARNED = "digit", "digit-single", "comparison/digit-tables"


@cache
def _compared(name: str) -> tuple[Scene, list[Sized], list[Refused]]:
    scene = load_scene(name)
    return scene, *compared(scene)


def design_rows(name: str, family: str = "xc2v") -> str:
    """What each design of a scene costs, and those that cannot be built."""
    scene, found, refused = _compared(name)
    table = designs(scene, found, family)
    lines = ["", *(f"- {line}" for line in refused_lines(refused))] if refused else []
    cells = [["" if cell is None else cell_text(cell) for cell in row] for row in table.rows]
    return "\n".join([markdown(" | ".join(table.columns), cells), *lines])


def design_spreads() -> str:
    """Every recorded network, estimated by a model that does not know its weights."""
    rows = []
    for one in held_out():
        row = one.recorded
        luts = [f"{row.size.luts}", f"{one.estimated.luts:.0f}", f"{one.percent:+.1f}"]
        rows.append([f"`{row.network}`", row.design, *luts])
    return markdown("network | design | LUTs | estimated | error %", rows)


def design_picture() -> str:
    """LUTs against clocks of the scene that every design of tanh neurons takes."""
    scene, found, _ = _compared(SINGLE)
    return picture_of(scene, found, "xc2v")


def profiles() -> str:
    """The loads of Figures 5.26 to 5.29, in the middle of the beam."""
    scene, loads = load_scene("thesis"), thesis_table("loads")
    targets = scene.vectors().targets
    frames = {}
    for name in thesis_table("load_function")["shown"]:
        load, width, shape = loads[name]
        same = np.isclose(targets, (load, MIDDLE, width, shape), atol=1e-3).all(axis=1)
        frames[f"load {name}"] = int(np.flatnonzero(same)[0])
    return load_profile(scene, frames)


# The coded position of the recorded loads that are nearest to the middle.
MIDDLE = 0.495
CELLS = ("logic cells", "flip-flops", "multipliers", "block RAMs")
# Who drives a wire, seen from the board.
INPUTS = ("miso", "rx")


def converters() -> str:
    """A line for each converter that a scene can name."""
    rows = []
    for name, part in PARTS.items():
        mhz = f"{32 / part.half_clocks(Fraction(64)):.3g} MHz"
        rows.append([f"`{name}`", part.source, part.bits, part.coding, part.clocks, mhz])
    heads = "name | data sheet | bits | coding | clocks of a transfer | sclk at 64 MHz"
    return markdown(heads, rows)


def wiring() -> str:
    """A table with a line for each port, and its pin on each board."""
    boards = [load_board(name) for name in board_names()]
    heads = [f"{board.title}, pin | where" for board in boards]
    rows = []
    for name in dict.fromkeys(name for board in boards for name in board.pins):
        cells = [f"`{name}`", "in" if name in INPUTS else "out"]
        for board in boards:
            pin = board.pins.get(name)
            more = ", lit by a 0" if pin and pin.inverted else ""
            cells += [f"`{pin.pin}`", f"{pin.at}{more}"] if pin else ["", ""]
        rows.append(cells)
    return markdown(" | ".join(["port | direction", *heads]), rows)


def pin_sources() -> str:
    lines = []
    for name in board_names():
        board = load_board(name)
        lines += [f"- {board.title}:", *(f"  - {source}" for source in board.sources)]
    return "\n".join(lines)


def resources() -> str:
    """The resources of each board that each recorded scene takes."""
    rows = []
    for scene in map(load_scene, scene_names()):
        for board in map(load_board, board_names()):
            path = record_path(scene, board)
            if path.is_file():
                report, _ = read_record(path)
                cells = _cells(report, scene.twin().clocks_after_samples)
                rows.append([scene.name, f"{board.title}, {board.device}", *cells])
    return markdown(f"scene | board | {' | '.join(CELLS)} | MHz needed | MHz reached | us", rows)


def _cells(report: Report, clocks: int) -> list[str]:
    counts = [
        f"{report.used[kind]} of {report.available[kind]} "
        f"({100 * report.used[kind] / report.available[kind]:.0f} %)"
        if kind in report.used
        else "in the logic cells"
        for kind in CELLS
    ]
    microseconds = f"{clocks / report.needed_mhz:.1f}"
    return [*counts, f"{report.needed_mhz:g}", f"{report.clock_mhz:g}", microseconds]


MADE: dict[str, Callable[[], str]] = {
    **{name: partial(keys, name) for name in SCENE["properties"]},
    "scenes": scenes,
    "classes": classes,
    "headline": lambda: as_page(headline()),
    "blocks": blocks.block_table,
    "sign-off": sign_off.overview,
    "synthesis": blocks.scene_table,
    "converters": converters,
    "wiring": wiring,
    "sources": pin_sources,
    "resources": resources,
    "digit": partial(design_rows, CASCADE),
    "digit-single": partial(design_rows, SINGLE),
    "ecp5": partial(design_rows, SINGLE, "ecp5"),
    "learned": partial(design_rows, LEARNED),
    "held-out": design_spreads,
    "picture-of-designs": partial(picture, design_picture),
    "floors": floors,
    "profiles": partial(picture, profiles),
    "networks": partial(picture, lambda: network(load_scene("digit"))),
    "segments": segments,
    "activation-errors": lambda: as_page(activation_table()),
    **{
        f"errors-of-{name.replace(' ', '_')}": partial(picture, partial(plot, name, scheme))
        for name, scheme in forms().items()
    },
    "pipeline": pipeline,
}
MARK = re.compile(r"<!-- made: ([\w-]+) -->")


@cache
def made(name: str) -> str:
    """The text of this name. A name that does not exist stops the building of the site."""
    return MADE[name]()
