"""What networks of four outputs cost, ours and the printed ones: clocks, errors, LUTs."""

from dataclasses import dataclass

from tactus.report.draw.named import Named, drawn, front
from tactus.report.measure.table import Row, Table, number, rows_of
from tactus.scene import load_scene, thesis_table

# The clocks of a scan of the thesis' front end, within which every network must finish.
SCAN_CLOCKS = 4096
# The networks of the digit that the thesis prints with their share of its device, and our scenes of
# the same hidden nodes, design and arithmetic.
PRINTED = {
    "cascade": ("digit.cascade_b", "digit-thesis"),
    "single": ("digit.hybrid", "digit-single-thesis"),
}
WORST, AFTER = "largest %", "clocks after the last sample"
ACROSS = "clocks from the last sample to the last output"


@dataclass(frozen=True)
class Design:
    """A network in the pictures; ``error`` is that of its worst output, in per cent."""

    name: str
    luts: float
    clocks: float
    error: float


def printed_designs() -> list[Design]:
    """The networks that the thesis prints, at the clocks of ours of the same form.

    The thesis itself prints no time for a frame.
    """
    device, found = thesis_table("device"), []
    for name, (key, scene) in PRINTED.items():
        printed = thesis_table(key)
        luts = printed["luts_percent"] * device["luts4"] / 100
        clocks = load_scene(scene).twin().output_clocks[-1]
        found.append(Design(f"thesis, {name}, printed", luts, clocks, max(printed["simulation"])))
    return found


def network_rows(table: Table) -> list[Row]:
    """The networks of four outputs that finish within a scan and have recorded cells.

    Instruments are left out, because they wait for their scan.
    """
    return [
        row
        for row in rows_of(table, data="appendix2", outputs=4)
        if row["LUT"] is not None and number(row, "interval clocks") < SCAN_CLOCKS
    ]


def scene_of(row: Row) -> str:
    """The name of a row's scene, without its folder."""
    return str(row["scene"]).removeprefix("comparison/")


def designs(table: Table) -> list[Design]:
    """Those networks and the printed ones, the one with the fewest LUTs first."""
    found = [
        Design(scene_of(row), number(row, "LUT"), number(row, AFTER), number(row, WORST))
        for row in network_rows(table)
    ]
    return sorted([*found, *printed_designs()], key=lambda one: (one.luts, one.clocks, one.name))


def area(table: Table) -> str:
    """Clocks against LUTs. Each name tells the error too."""
    points = [Named(f"{d.name}, {d.error:.2f} %", d.clocks, d.luts) for d in designs(table)]
    title = "The same four outputs: area against clocks, and the error of the worst output"
    return _picture(points, "area", title, ACROSS, "Virtex-II LUTs, entity by entity")


def networks(table: Table) -> str:
    """Clocks against the error of the worst output."""
    points = [Named(one.name, one.clocks, one.error) for one in designs(table)]
    clock = float(thesis_table("board")["clock_mhz"])
    across = f"{ACROSS}; {clock:g} are 1 µs for the thesis"
    title = "The same four outputs: error against clocks"
    return _picture(points, "networks", title, across, "error of the worst output, %")


def _picture(points: list[Named], name: str, title: str, across: str, up: str) -> str:
    best = ", ".join(one.name for one in front(points))
    return drawn(points, name, title, across, up, f"Not beaten on both axes: {best}.")
