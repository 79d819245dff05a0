"""What networks cost: their errors against clocks, and the networks that the thesis prints."""

from collections.abc import Sequence
from dataclasses import dataclass

from tactus.report.draw.drawing import picture, text
from tactus.report.draw.named import Axes, Named, drawn, front
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


@dataclass(frozen=True)
class Disc:
    """A design in a picture.

    error: In per cent; 0 where the picture does not show it.
    """

    name: str
    luts: float
    multipliers: float
    clocks: float
    error: float = 0.0


def printed_discs() -> list[Disc]:
    """The networks that the thesis prints, at the clocks of ours of the same form.

    The thesis itself prints no time for a frame.
    """
    device, found = thesis_table("device"), []
    for name, (key, scene) in PRINTED.items():
        printed = thesis_table(key)
        luts = printed["luts_percent"] * device["luts4"] / 100
        multipliers = printed["mult18x18_percent"] * device["mult18x18"] / 100
        error = max(printed["simulation"])
        clocks = load_scene(scene).twin().output_clocks[-1]
        found.append(Disc(f"thesis, {name}", luts, multipliers, clocks, error))
    return found


def in_order(found: Sequence[Disc]) -> list[Disc]:
    """The design with the fewest LUTs first."""
    return sorted(found, key=lambda disc: (disc.luts, disc.clocks, disc.name))


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
