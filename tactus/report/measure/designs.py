"""What each design of a scene's networks costs, without synthesis."""

from collections.abc import Sequence
from math import ceil

from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene
from tactus.sizing.candidates import Refused, Sized, front

FAMILIES = {
    "xc2v": "Virtex-II, LUT of 4 inputs; multipliers of 18 x 18 bits, block RAMs of 18 Kbit",
    "ecp5": "ECP5, LUT of 4 inputs; multipliers of 18 x 18 bits, block RAMs of 18 Kbit",
}
FRONT = "*"


def designs(scene: Scene, rows: Sequence[Sized], family: str) -> Table:
    """The costs of each design; those that no other one beats in every column are marked."""
    cells: list[list[Cell]] = []
    for row, first in zip(rows, front(rows, family), strict=True):
        found = row.cells(family)
        if found is None:
            continue
        spread = None if found.spread is None else ceil(found.spread)
        cells.append(
            [
                FRONT if first else "",
                row.candidate.name,
                round(found.size.luts),
                spread,
                round(found.size.flip_flops),
                found.multipliers,
                found.block_rams,
                row.clocks,
                row.interval,
                row.worst,
                row.mean,
                None if found.clock_mhz is None else round(found.clock_mhz),
            ]
        )
    return Table(
        "designs",
        [
            "front",
            "design",
            "LUTs",
            "+- %",
            "flip-flops",
            "multipliers",
            "block RAMs",
            "clocks",
            "interval",
            "largest error",
            "mean error",
            "MHz",
        ],
        cells,
        f"The networks {scene.describe()} of scene {scene.name} in each design, for {family} "
        f"({FAMILIES[family]}). Multipliers, block RAMs, clocks and interval are exact. LUTs, "
        "flip-flops and MHz are estimates from recorded syntheses; '+- %' is the largest error of "
        "LUTs among recorded networks of the design that the estimate did not know. Clocks are "
        "those from the last sample to the last output, and the interval those from frame to "
        "frame. Errors are differences from the networks in floating point over the recorded "
        "frames, in units of 2^-13. No design beats one marked '*' in every column.",
    )


def refused_lines(refused: Sequence[Refused]) -> list[str]:
    """A line for each design that cannot be built, with the reason.

    Where it is the same for all options of a design, they share a line.
    """
    found: dict[tuple[str, str], list[str]] = {}
    for one in refused:
        found.setdefault((one.candidate.design, one.reason), []).append(one.candidate.name)
    return [
        f"{names[0] if len(names) == 1 else design}: not possible: {reason}"
        for (design, reason), names in found.items()
    ]
