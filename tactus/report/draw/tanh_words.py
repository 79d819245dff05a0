"""Draws the largest error of an engine's tanh against the number of words of its table."""

from tactus.report.draw.axes import Axes
from tactus.report.draw.drawing import ACCENT, INK, dot, line, picture, text
from tactus.report.draw.findings import number, rows_of
from tactus.report.measure.table import Table

SIZE = (400.0, 348.0)


def tanh_words(table: Table) -> str:
    """One line for each width of a segment. Its points are tables that end later and later.

    The filled points are the tables that ``hardware.segment_width`` can choose.
    """
    axes = Axes(46, 52, 336, 236, (25, 2000), (0.1, 8))
    body = [text((6, 18), "tanh of an engine, over all codes", 13, font_weight="bold")]
    body += axes.drawn("words of the table", "largest error, units of 2^-13")
    for width in dict.fromkeys(row["segment width"] for row in rows_of(table)):
        rows = rows_of(table, segment_width=width)
        points = [axes.at(number(row, "words"), number(row, "largest units")) for row in rows]
        body.append(line(points, stroke=ACCENT))
        for row, point in zip(rows, points, strict=True):
            fill = ACCENT if row["engine"] == "yes" else "#fff"
            body.append(dot(point, 3.5, fill=fill, stroke=ACCENT))
        x, y = points[0]
        body.append(text((x, y - 8), f"{width}", text_anchor="middle", fill=INK))
    note = "number: segment_width; filled: what an engine may have"
    body.append(text((6, SIZE[1] - 10), note))
    return picture(f"Largest error of tanh by words of its table. {sentence(table)}", SIZE, body)


def sentence(table: Table) -> str:
    """A sentence that says what the picture shows."""
    told = ", ".join(
        f"{number(row, 'words'):g} words to {number(row, 'largest units'):.3f}"
        for row in rows_of(table, engine="yes")
    )
    return f"In units of 2^-13: {told}."
