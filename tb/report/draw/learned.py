"""Draws the functions of a network of learned functions, with the rows of the data below each."""

from __future__ import annotations

from collections.abc import Sequence

from tb.report.draw.drawing import ACCENT, FAINT, Point, box, group, line, picture, text
from tb.report.measure.function_tables import BINS, POINTS
from tb.report.measure.table import Cell, Table

LEFT, TOP = 64.0, 66.0
# A cell holds one function: its size, the part that the curve has, and the gaps between cells.
CELL, CURVE, GAP = (64.0, 44.0), 32.0, 6.0
# The gap between the networks.
BETWEEN = 22.0
# The part of the rows that fills the strip below a curve.
FULL = 0.25

Row = Sequence[Cell]


def learned_curves(table: Table) -> str:
    """The picture of table ``learned_curves``: a line for each node, a column for each input."""
    networks = list(dict.fromkeys(str(row[0]) for row in table.rows))
    widest = max(len(_node(table, name, 1)) for name in networks)
    body = [
        text((6, 18), "The functions that the cascade has learned", 13, font_weight="bold"),
        text((6, 36), "each line is a node: the functions of its inputs, and right the function"),
        text((6, 51), "of their sum; below: how many rows of the data lie there"),
    ]
    y = TOP
    for name in networks:
        first = _node(table, name, 1)
        nodes = 1 + max(int(str(row[1])) for row in table.rows if row[0] == name)
        body.append(text((6, y + 12), name, font_weight="bold"))
        for c, row in enumerate(first):
            heading = "their sum" if c == len(first) - 1 else str(row[2])
            column = widest - 1 if c == len(first) - 1 else c
            body.append(text((_x(column), y + 12), heading, 10))
        y += 18
        for node in range(1, nodes):
            found = _node(table, name, node)
            body.append(text((6, y + CURVE / 2 + 4), f"node {node}"))
            most = _height(found[:-1])
            for c, row in enumerate(found[:-1]):
                body.append(_function(row, (_x(c), y), most))
            outer = [_node(table, name, n)[-1] for n in range(1, nodes)]
            body.append(_function(found[-1], (_x(widest - 1), y), _height(outer)))
            y += CELL[1] + GAP
        y += BETWEEN - GAP
    counts = {form: sum(row[3] == form for row in table.rows) for form in FORMS}
    title = ", ".join(f"{count} {form}" for form, count in counts.items())
    title = f"Learned functions of {', '.join(networks)}: {title}."
    return picture(title, (_x(widest) + 6, y), body, widest=720)


FORMS = ("curved", "straight", "flat")


def _node(table: Table, network: str, node: int) -> list[Row]:
    return [row for row in table.rows if row[0] == network and row[1] == node]


def _x(column: int) -> float:
    return LEFT + column * (CELL[0] + GAP)


def _values(row: Row) -> list[float]:
    return [float(str(cell)) for cell in row[6 : 6 + POINTS]]


def _height(rows: Sequence[Row]) -> float:
    """The largest value of some functions, which all have the same scale."""
    return max((abs(value) for row in rows for value in _values(row)), default=1.0) or 1.0


def _function(row: Row, at: Point, most: float) -> str:
    """One function with the rows below it; a flat one is an empty frame."""
    x, y = at
    width, height = CELL
    name = f"{row[0]}, node {row[1]}, {row[2]}: {row[3]}"
    body = [box(at, CELL, stroke=FAINT, stroke_width=0.5)]
    if row[3] != "flat":
        middle = y + CURVE / 2
        points = [
            (x + width * n / (POINTS - 1), middle - value / most * (CURVE / 2 - 2))
            for n, value in enumerate(_values(row))
        ]
        colour = ACCENT if row[3] == "curved" else FAINT
        body.append(line(points, stroke=colour, stroke_width=1.4))
    bottom = y + height
    outline = [(x, bottom)]
    for n, cell in enumerate(row[6 + POINTS :]):
        top = bottom - min(float(str(cell)) / FULL, 1.0) * (height - CURVE)
        outline += [(x + width * n / BINS, top), (x + width * (n + 1) / BINS, top)]
    body.append(line([*outline, (x + width, bottom)], stroke=FAINT, stroke_width=0.8))
    return group(body, name)
