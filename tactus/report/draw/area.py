"""Draws the cost of networks with four outputs: LUTs against clocks, with the error of each."""

from tactus.report.draw.drawing import picture, text
from tactus.report.draw.named import Axes, Named, drawn, front
from tactus.report.draw.run_time import SCAN_CLOCKS, Disc, in_order, printed_discs
from tactus.report.measure.table import Table, number, rows_of


def designs(table: Table) -> list[Disc]:
    """The networks of four outputs that finish within a scan, and the printed ones.

    The network with the fewest LUTs comes first. Scenes with a front end are left out, because they
    are not networks alone and wait for their scan.
    """
    found = [
        Disc(
            str(row["scene"]).removeprefix("comparison/"),
            number(row, "LUT"),
            number(row, "multiplier"),
            number(row, "clocks after the last sample"),
            number(row, "largest %"),
        )
        for row in rows_of(table, data="appendix2", outputs=4)
        if row["LUT"] is not None and number(row, "interval clocks") < SCAN_CLOCKS
    ]
    return in_order([*found, *printed_discs()])


def points(table: Table) -> list[Named]:
    """The designs by clocks and LUTs. Each name tells the error too."""
    return [Named(f"{one.name}, {one.error:.2f} %", one.clocks, one.luts) for one in designs(table)]


def area(table: Table) -> str:
    """Every design with its name; the front is drawn, and what it beats is grey."""
    title = "The same four outputs: area against clocks, and the error of the worst output"
    axes = Axes(46, 58, 660, 380, (4, 4000), (80, 12000))
    body = [text((6, 18), title, 13, font_weight="bold")]
    body += axes.drawn(
        "clocks from the last sample to the last output", "Virtex-II LUTs, entity by entity"
    )
    said = f"{title}. {sentence(table)}"
    return picture(said, (720, 480), [*body, *drawn(points(table), axes)], 560, 860)


def sentence(table: Table) -> str:
    """A sentence that says what the picture shows."""
    best = front(points(table))
    return f"Not beaten on both axes: {'; '.join(one.name for one in best)}."
