"""The headline and the picture of docs/error-against-run-time.md.

Errors, clocks and cells are computed; the rest of the page is written by hand.
"""

from collections.abc import Iterator

from tactus.report.draw.run_time import AFTER, PRINTED, SCAN_CLOCKS, WORST, scene_of
from tactus.report.measure.table import Row, Table, number, rows_of
from tactus.scene import thesis_table

SCENE, REBUILT = "digit", "digit-thesis"
HELD_OUT = "held out %"


def headline(networks: Table) -> Iterator[str]:
    """The default network beside the thesis' cascade, by the same measures; and the scan."""
    default, rebuilt = (_network(networks, scene) for scene in (SCENE, REBUILT))
    clock = float(thesis_table("board")["clock_mhz"])
    ratio = number(default, AFTER) / number(rebuilt, AFTER)

    def told(row: Row) -> str:
        return (
            f"errs by {number(row, HELD_OUT):.2f} % on held-out rows, in {_us(row, clock)} µs on "
            f"{number(row, 'multiplier'):.0f} multiplier{'s' * (number(row, 'multiplier') != 1)}, "
            f"{number(row, 'block RAM'):.0f} block RAMs and {number(row, 'LUT'):,.0f} LUTs"
        )

    yield (
        f"**The default network (scene `{SCENE}`) {told(default)}; the thesis' cascade, rebuilt "
        f"(`{REBUILT}`), {told(rebuilt)}.** So the default is {ratio:.1f} times as slow, and "
        "both are much faster than the scan of the sensors, for which they wait."
    )
    yield ""
    heads = (
        *("", "error held out, %", "error on recorded rows, %", "clocks", f"µs at {clock:g} MHz"),
        *("LUTs, entity by entity", "multipliers", "block RAMs"),
    )
    yield f"| {' | '.join(heads)} |"
    yield f"|{'---|' * len(heads)}"
    device, printed = thesis_table("device"), thesis_table(PRINTED["cascade"][0])
    for name, row in ((f"`{SCENE}`", default), (f"`{REBUILT}`", rebuilt)):
        cells = (
            *(
                f"{number(row, HELD_OUT):.2f}",
                f"{number(row, WORST):.2f}",
                f"{number(row, AFTER):,.0f}",
                _us(row, clock),
            ),
            *(f"{number(row, 'LUT'):,.0f}", f"{number(row, 'multiplier'):.0f}"),
            f"{number(row, 'block RAM'):.0f}",
        )
        yield f"| {name} | {' | '.join(cells)} |"
    shares = (
        f"about {printed[share] * device[count] / 100:,.0f}"
        for share, count in (("luts_percent", "luts4"), ("mult18x18_percent", "mult18x18"))
    )
    error = f"{max(printed['simulation']):.2f}; {max(printed['real_time']):.2f} with real sensors"
    yield f"| cascade, as printed | | {error} | | | {' | '.join(shares)} | |"
    yield f"| scan of the sensors | | | {SCAN_CLOCKS:,} | {SCAN_CLOCKS / clock:g} | | | |"
    yield ""
    yield (
        "Held out is the mean error of the worst output on rows that no training had seen: for "
        f"`{SCENE}` stretches, which is harder, and for `{REBUILT}` rows drawn at random. After "
        f"that `{SCENE}` was trained further on all rows. The error on recorded rows is the mean "
        "at the worst position, as the thesis prints it. Clocks count from the last sample to the "
        "last output; the thesis prints no time for a frame. A vendor's tool placed its LUTs, "
        "Yosys maps ours and counts no inverters."
    )


def _network(networks: Table, scene: str) -> Row:
    (found,) = (row for row in rows_of(networks) if scene_of(row) == scene)
    return found


def _us(row: Row, clock: float) -> str:
    return f"{number(row, AFTER) / clock:.2f}"
