"""The printed thesis, its networks rebuilt, and the default scene: the same table for all pages.

All have the same sensors and outputs. Cells are those that ``make synth`` recorded.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from tactus.errors import held_out_means, scene_errors
from tactus.report.draw.run_time import SCAN_CLOCKS
from tactus.report.measure.networks import FAMILY
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene, thesis_table
from tactus.synth.budget import read_budget

# The networks that the pages show.
SHOWN = "digit"
# The networks with the hidden nodes that the thesis prints, without the blocks around them.
REBUILT = "digit-thesis"
# The same networks with a scan and a profile around them.
INSTRUMENTS = ("thesis", "digit-instrument")


def facts(scene: Scene) -> dict[str, Any]:
    """The errors of the worst output in percent, the clocks, and the recorded cells."""
    design = scene.twin()
    return {
        "held out": max(held_out_means(scene) or [], default=None),
        "error": max(error.largest_mean for error in scene_errors(scene)["bit-true"]),
        "clocks": design.clocks_after_samples,
        **read_budget(scene.path)[FAMILY][design.entity],
    }


@cache
def headline(proved: tuple[bool, ...] = (True, True)) -> Table:
    """The table.

    proved: Whether the networks are proved, those of the thesis first. Tests prove both.
    """
    scenes = [load_scene(name) for name in (REBUILT, SHOWN)]
    printed, clock = thesis_table(scenes[0].reference), float(thesis_table("board")["clock_mhz"])
    luts, multipliers = printed_cells(printed)
    found = [facts(scene) for scene in scenes]
    whole = [facts(load_scene(name))["LUT"] for name in INSTRUMENTS]

    def percent(error: float) -> str:
        return f"{error:.2f} %"

    rows: list[list[Cell]] = [
        ["mean error on held-out rows", "-", *(percent(one["held out"]) for one in found)],
        [
            "mean error at the worst position",
            *map(percent, (max(printed["simulation"]), *(one["error"] for one in found))),
        ],
        ["the same, with real sensors", percent(max(printed["real_time"])), "-", "-"],
        ["clocks after the last sample", "-", *(str(one["clocks"]) for one in found)],
        [
            f"the same in µs at {clock:g} MHz",
            "-",
            *(f"{one['clocks'] / clock:.2f}" for one in found),
        ],
        ["LUTs", luts, *(f"{one['LUT']:,}" for one in found)],
        ["LUTs with scan and profile", "not said", *(f"{count:,}" for count in whole)],
        ["multipliers", multipliers, *(str(one["multiplier"]) for one in found)],
        ["block RAMs", "-", *(str(one["block RAM"]) for one in found)],
        [
            "proved for",
            "-",
            *(
                f"all 2^{14 * len(scene.sensors)} frames" if shown else "not proved"
                for scene, shown in zip(scenes, proved, strict=True)
            ),
        ],
    ]
    note = (
        "Errors are those of the worst of four outputs, bit-true, on recorded rows. Held out are "
        f"rows that no training had seen: for {SHOWN} stretches, which is harder, and for "
        f"{REBUILT} rows drawn at random. After that {SHOWN} was trained further on all rows. "
        "LUTs are counted entity by entity. A vendor's tool placed those of the thesis; Yosys maps "
        "ours and counts no inverters."
    )
    heads = ["", "thesis, printed", f"thesis, rebuilt ({REBUILT})", f"our own ({SHOWN})"]
    return Table("headline", heads, rows, note)


def printed_cells(printed: Mapping[str, Any]) -> Iterator[str]:
    """LUTs and multipliers of a network that the thesis prints in percent of its device."""
    device = thesis_table("device")
    for share, kind in (("luts_percent", "luts4"), ("mult18x18_percent", "mult18x18")):
        yield f"about {printed[share] * device[kind] / 100:,.0f}"


def against_run_time() -> str:
    """The default network beside the thesis' cascade, in a sentence; and the scan."""
    clock = float(thesis_table("board")["clock_mhz"])
    default, rebuilt = (facts(load_scene(name)) for name in (SHOWN, REBUILT))

    def told(one: dict[str, Any]) -> str:
        return (
            f"errs by {one['held out']:.2f} % on held-out rows, in {one['clocks'] / clock:.2f} µs "
            f"on {one['multiplier']} multiplier{'s' * (one['multiplier'] != 1)}, "
            f"{one['block RAM']} block RAMs and {one['LUT']:,} LUTs"
        )

    return (
        f"**The default network (scene `{SHOWN}`) {told(default)}; the thesis' cascade, rebuilt "
        f"(`{REBUILT}`), {told(rebuilt)}.** So the default is "
        f"{default['clocks'] / rebuilt['clocks']:.1f} times as slow, and both are much faster than "
        f"the scan of the sensors, for which they wait: {SCAN_CLOCKS:,} clocks, "
        f"{SCAN_CLOCKS / clock:g} µs."
    )
