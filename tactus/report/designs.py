"""``make designs``: prints what each design of a scene's networks costs, without synthesis."""

import textwrap
from collections.abc import Sequence
from math import ceil

from golden.input_error import InputError, suggest
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.report.draw.named import Named, drawn
from tactus.report.draw.run_time import ACROSS, PRINTED, printed_designs
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene
from tactus.scene.building import compared
from tactus.sizing.candidates import Refused, Sized, front
from tactus.sizing.model import placed

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
        spread = None if found.spread is None else ceil(found.spread)
        cells.append(
            [
                FRONT if first else "",
                row.candidate.name,
                round(found.luts),
                spread,
                round(found.flip_flops),
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


def points(scene: Scene, rows: Sequence[Sized], family: str) -> list[Named]:
    """The designs of a scene, and those that the thesis prints for the digit, fewest LUTs first."""
    found = [Named(row.candidate.name, row.clocks, row.cells(family).luts) for row in rows]
    if scene.reference in [key for key, _ in PRINTED.values()] and family == "xc2v":
        found += [Named(one.name, one.clocks, one.luts) for one in printed_designs()]
    return sorted(found, key=lambda one: (one.y, one.x, one.name))


def picture_of(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    """Every design with its name; the front is drawn, and what it beats is grey."""
    found, said = points(scene, rows, family), sentence(scene, rows, family)
    title = f"{scene.name}: LUTs against clocks"
    return drawn(found, "designs", title, ACROSS, f"LUTs of {family}", said)


def sentence(scene: Scene, rows: Sequence[Sized], family: str) -> str:
    found = points(scene, rows, family)
    if not found:
        return "No design can be built."
    least, fastest = found[0], min(found, key=lambda one: (one.x, one.y))
    return (
        f"{least.name} is the smallest, with {least.y:,.0f} LUTs and {least.x:,.0f} "
        f"clocks; {fastest.name} is the fastest, with {fastest.y:,.0f} and {fastest.x:,.0f}."
    )


def family_of(name: str) -> str:
    """A name of ``FAMILIES``; none is the first."""
    if not name:
        return next(iter(FAMILIES))
    if name not in FAMILIES:
        raise InputError(
            f"FAMILY={name}: no such family, expected one of {', '.join(FAMILIES)}"
            f"{suggest(name, list(FAMILIES))}"
        )
    return name


def main() -> None:
    arguments = arguments_of("designs", __doc__)
    family = family_of(arguments.family)
    scene = load_scene(arguments.scene)
    stop_if_dry_run(f"compare the designs of scene {scene.name}")
    rows, refused = compared(scene)
    if family == "ecp5":
        reason = "no network with these options was placed and routed, so its cells are unknown"
        refused += [Refused(row.candidate, reason) for row in rows if not placed(row.kind)]
        rows = [row for row in rows if placed(row.kind)]
    print("\n".join(designs(scene, rows, family).lines()))
    if refused:
        print()
        for line in refused_lines(refused):
            print(textwrap.fill(line, 100, subsequent_indent="  "))
