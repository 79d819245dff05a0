"""Wiring and resources of boards.

The wiring is in the file of the board. ``make bitstream RECORD=1`` records beside a scene what it
takes.
"""

from fractions import Fraction

from golden.sensing.converter_parts import PARTS
from tactus.boards import board_names, load_board
from tactus.boards.bitstream import Report, read_record, record_path
from tactus.report.measure.table import markdown
from tactus.scene import load_scene, scene_names

KINDS = ("logic cells", "flip-flops", "multipliers", "block RAMs")
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
    """The sources of the pins."""
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
                cells = _cells(report, scene.twin().output_clocks[-1])
                rows.append([scene.name, f"{board.title}, {board.device}", *cells])
    return markdown(f"scene | board | {' | '.join(KINDS)} | MHz needed | MHz reached | us", rows)


def _cells(report: Report, clocks: int) -> list[str]:
    counts = [
        f"{report.used[kind]} of {report.available[kind]} "
        f"({100 * report.used[kind] / report.available[kind]:.0f} %)"
        if kind in report.used
        else "in the logic cells"
        for kind in KINDS
    ]
    microseconds = f"{clocks / report.needed_mhz:.1f}"
    return [*counts, f"{report.needed_mhz:g}", f"{report.clock_mhz:g}", microseconds]
