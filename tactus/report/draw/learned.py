"""Draws the functions of a network of learned functions, with the rows of the data below each."""

from collections.abc import Sequence

from tactus.report.draw.drawing import ACCENT, FAINT, Point, box, group, line, picture, text
from tactus.report.measure.learned_edges import BINS, POINTS, SUM, VALUES
from tactus.report.measure.table import Cell, Table

LEFT, TOP = 64.0, 66.0
# A cell holds one function: its size, the part that the curve has, and the gaps between cells.
CELL, CURVE, GAP = (64.0, 44.0), 32.0, 6.0
# The gap between the networks.
BETWEEN = 22.0
# The part of the rows that fills the strip below a curve.
FULL = 0.25

Row = Sequence[Cell]


def learned_curves(table: Table, whose: str) -> str:
    """A line for each node, and a column for each input and for each function of a sum.

    table: See ``tactus.report.measure.learned_edges.edges_table``.
    whose: What has learned the functions.
    """
    networks = list(dict.fromkeys(str(row[0]) for row in table.rows))
    inner, outer = (
        max(len(_node(table, name, 1, outer=side)) for name in networks) for side in (False, True)
    )
    body = [
        text((6, 18), f"The functions that {whose} has learned", 13, font_weight="bold"),
        text((6, 36), "each line is a node: the functions of its inputs, and right the function"),
        text((6, 51), "of their sum; below: how many rows of the data lie there"),
    ]
    y = TOP
    for name in networks:
        nodes = 1 + max(int(str(row[1])) for row in table.rows if row[0] == name)
        body.append(text((6, y + 12), name, font_weight="bold"))
        heads = [str(row[3]) for row in _node(table, name, 1, outer=False)]
        sums = [f"for {row[3]}" for row in _node(table, name, 1, outer=True)]
        for c, heading in [*enumerate(heads), *enumerate(sums, inner)]:
            body.append(text((_x(c), y + 12), heading, 10))
        y += 18
        # All functions of sums have one scale, and those of the inputs of one node.
        most = _height([row for n in range(1, nodes) for row in _node(table, name, n, outer=True)])
        for node in range(1, nodes):
            found = _node(table, name, node, outer=False)
            body.append(text((6, y + CURVE / 2 + 4), f"node {node}"))
            own = _height(found)
            for c, row in enumerate(found):
                body.append(_function(row, (_x(c), y), own))
            for c, row in enumerate(_node(table, name, node, outer=True), inner):
                body.append(_function(row, (_x(c), y), most))
            y += CELL[1] + GAP
        y += BETWEEN - GAP
    counts = {form: sum(row[4] == form for row in table.rows) for form in FORMS}
    title = ", ".join(f"{count} {form}" for form, count in counts.items())
    title = f"Learned functions of {', '.join(networks)}: {title}."
    return picture(title, (_x(inner + outer) + 6, y), body, widest=720)


FORMS = ("curved", "straight", "flat")


def _node(table: Table, network: str, node: int, outer: bool) -> list[Row]:
    """The functions of the inputs of a node, or those of its sum."""
    return [
        row
        for row in table.rows
        if row[0] == network and row[1] == node and (row[2] == SUM) == outer
    ]


def _x(column: int) -> float:
    return LEFT + column * (CELL[0] + GAP)


def _values(row: Row) -> list[float]:
    return [float(str(cell)) for cell in row[VALUES : VALUES + POINTS]]


def _height(rows: Sequence[Row]) -> float:
    """The largest value of some functions, which all have the same scale."""
    return max((abs(value) for row in rows for value in _values(row)), default=1.0) or 1.0


def _function(row: Row, at: Point, most: float) -> str:
    """One function with the rows below it; a flat one is an empty frame."""
    x, y = at
    width, height = CELL
    of = f"sum for {row[3]}" if row[2] == SUM else row[3]
    name = f"{row[0]}, node {row[1]}, {of}: {row[4]}"
    body = [box(at, CELL, stroke=FAINT, stroke_width=0.5)]
    if row[4] != "flat":
        middle = y + CURVE / 2
        points = [
            (x + width * n / (POINTS - 1), middle - value / most * (CURVE / 2 - 2))
            for n, value in enumerate(_values(row))
        ]
        colour = ACCENT if row[4] == "curved" else FAINT
        body.append(line(points, stroke=colour, stroke_width=1.4))
    bottom = y + height
    outline = [(x, bottom)]
    for n, cell in enumerate(row[VALUES + POINTS :]):
        top = bottom - min(float(str(cell)) / FULL, 1.0) * (height - CURVE)
        outline += [(x + width * n / BINS, top), (x + width * (n + 1) / BINS, top)]
    body.append(line([*outline, (x + width, bottom)], stroke=FAINT, stroke_width=0.8))
    return group(body, name)
