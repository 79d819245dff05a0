"""Draws the packages of the four rooms on their floors, from the contracts of import-linter."""

import textwrap
import tomllib

from tactus.core.fingerprint import ROOT
from tactus.report.draw.drawing import FAINT, Point, arrow_head, box, line, picture, text

ROOMS = ("golden", "hdl", "tb", "tactus")
LETTERS = 34
WIDTH, LINE, SIZE = 230.0, 14.0, 11.0
MARGIN, GAP, HEAD, BETWEEN = 12.0, 28.0, 26.0, 6.0


def floors(room: str) -> list[list[str]]:
    """The packages of a room, from the top floor down."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (contract,) = (c for c in contracts if c.get("containers") == [room])
    return [layer.split(" | ") for layer in contract["layers"]]


def _floor(at: Point, lines: list[str]) -> list[str]:
    x, y = at
    names = [text((x + 8, y + LINE * (n + 1)), words, SIZE) for n, words in enumerate(lines)]
    return [box(at, (WIDTH, _height(lines)), rx=3), *names]


def _height(lines: list[str]) -> float:
    return LINE * len(lines) + 6


def picture_of_floors() -> str:
    """One ``<svg>`` element with a column for each room and a box for each floor.

    Imports go down within a column, and from a column to the columns at its left.
    """
    boxes = {
        room: [textwrap.wrap(", ".join(names), LETTERS) for names in floors(room)] for room in ROOMS
    }
    heights = {r: sum(_height(lines) + BETWEEN for lines in b) for r, b in boxes.items()}
    ground = MARGIN + HEAD + max(heights.values())
    body: list[str] = []
    for n, room in enumerate(ROOMS):
        x, y = MARGIN + n * (WIDTH + GAP), ground - heights[room]
        body.append(text((x, y - 8), f"{room}/", 13, font_weight="bold"))
        if n:
            body.append(line([(x - 6, ground - 30), (x - GAP + 8, ground - 30)], stroke=FAINT))
            body.append(arrow_head((x - GAP + 5, ground - 30), (-1, 0), FAINT))
        for lines in boxes[room]:
            body += _floor((x, y), lines)
            y += _height(lines) + BETWEEN
    width = 2 * MARGIN + len(ROOMS) * WIDTH + (len(ROOMS) - 1) * GAP
    title = "The packages of the four rooms on their floors; imports go down and to the left"
    return picture(title, (width, ground + MARGIN), body, narrowest=640, widest=860)
