"""Draws the picture of docs/error-against-run-time.md: the error of networks against clocks."""

from tactus.report.draw.axes import Axes
from tactus.report.draw.discs import PRINTED, SCAN_CLOCKS
from tactus.report.draw.drawing import picture, text
from tactus.report.draw.findings import Row, number, rows_of
from tactus.report.draw.named import Named, drawn, front
from tactus.report.measure.table import Table
from tactus.scene import thesis_table

WORST, AFTER = "largest %", "clocks after the last sample"


def network_rows(table: Table) -> list[Row]:
    """The networks of the digit that have recorded cells, least error first.

    Instruments are left out, because they wait for their scan.
    """
    found = [
        row
        for row in rows_of(table, data="appendix2")
        if row["LUT"] is not None and number(row, "interval clocks") < SCAN_CLOCKS
    ]
    # Two engines with the same networks have the same error, except for the last bits of a sum.
    return sorted(found, key=lambda row: (round(number(row, WORST), 6), number(row, "LUT")))


def network_points(table: Table) -> list[Named]:
    """Networks of four outputs, by clocks and error, and the printed errors of the thesis.

    The thesis prints no time for a frame. Its networks stand at the clocks of those that are
    rebuilt with its hidden nodes, in its design and arithmetic.
    """
    rows = {scene_of(row): row for row in network_rows(table) if row["outputs"] == 4}
    found = [Named(name, number(row, AFTER), number(row, WORST)) for name, row in rows.items()]
    return found + [
        Named(f"{name}, as printed", number(rows[scene], AFTER), error)
        for name, (scene, error) in printed_errors().items()
    ]


def scene_of(row: Row) -> str:
    """The name of a row's scene, without its folder."""
    return str(row["scene"]).removeprefix("comparison/")


def printed_errors() -> dict[str, tuple[str, float]]:
    """For each printed network: our scene of the same form, and its error in simulation.

    The error is that of the worst output.
    """
    return {
        f"thesis, {name}": (scene, max(thesis_table(key)["simulation"]))
        for name, (key, scene) in PRINTED.items()
    }


def networks(table: Table) -> str:
    """The worst output of every network against the clocks after the last sample."""
    points = network_points(table)
    title = "The same four outputs: error against clocks"
    axes = Axes(46, 58, 660, 330, (4, 4000), (0.3, 20))
    clock = float(thesis_table("board")["clock_mhz"])
    body = [text((6, 18), title, 13, font_weight="bold")]
    across = f"clocks from the last sample to the last output; {clock:g} are 1 µs for the thesis"
    body += axes.drawn(across, "error of the worst output, %")
    said = f"{title}. Not beaten on both axes: {', '.join(one.name for one in front(points))}."
    return picture(said, (720, 430), [*body, *drawn(points, axes)], widest=860)
