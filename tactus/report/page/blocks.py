"""The table of blocks, and the sections of each block's page, which the site shows.

Formats and clocks are those of every scene, and of every case of a bench.
"""

import importlib
import inspect
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory

from golden.common.block import Block, walk
from golden.common.port import Port, Unsigned
from golden.numbers.fixed import Fix
from tactus.report.measure.networks import scenes
from tactus.report.measure.table import markdown
from tactus.report.page.sign_off import sheet
from tactus.scene import Scene
from tactus.synth.budget import Cells, is_recorded, read_budget, shares
from tactus.synth.cells import FAMILIES, FLAT_FAMILY, KINDS, flat_name
from tactus.synth.timing import read_timing
from tactus.verify.benches.collected import CASES, case_scene


def recorded() -> Iterator[tuple[Scene, Cells]]:
    """Every scene that has a budget, with its budget."""
    return ((s, read_budget(s.path)) for s in scenes() if is_recorded(s.path))


def block_tables() -> dict[str, str]:
    """The lines for each datasheet, with the entity of the most LUTs in each family."""
    largest: dict[str, dict[str, tuple[int, str, str, dict[str, int]]]] = {}
    for scene, cells in recorded():
        for part in walk(scene.twin()):
            for family in FAMILIES:
                found = cells[family][part.entity]
                candidate = (found["LUT"], scene.name, part.entity, found)
                best = largest.setdefault(part.block, {})
                if family not in best or candidate[0] > best[family][0]:
                    best[family] = candidate
    return {block: _block_table(best) for block, best in largest.items()}


def _block_table(best: dict[str, tuple[int, str, str, dict[str, int]]]) -> str:
    rows = [
        [
            FAMILIES[family].split(",")[0],
            f"{scene}, `{entity}`",
            *(found[column] for column in KINDS),
        ]
        for family, (_, scene, entity, found) in best.items()
    ]
    return (
        "For each family, the table shows the entity of this block with the most LUTs in any\n"
        "scene, with its parts included (`make synth`):\n\n"
        + markdown(" | ".join(["family | scene, entity", *KINDS]), rows)
    )


def scene_table() -> str:
    """A table with a line for each scene: cells, shares of the thesis' device, and clock."""
    heads = (
        "scene | LUT, entity by entity | LUT, in one piece | flip-flop | multiplier | block RAM | "
        "% LUTs (thesis) | % multipliers (thesis) | clocks | ECP5 MHz | us | "
        "frames a second"
    )
    rows = []
    for scene, cells in recorded():
        design = scene.twin()
        top = cells["xc2v"][design.entity]
        share = shares(scene, design, cells)
        printed = share.get("thesis", {})
        percents = [
            f"{share[name]:.0f} ({printed.get(name, '-')})"
            for name in ("luts_percent", "mult18x18_percent")
        ]
        timing, _ = read_timing(scene.path)
        row: list[object] = [
            scene.name,
            top["LUT"],
            cells[FLAT_FAMILY][flat_name(design.entity)]["LUT"],
            *(top[kind] for kind in ("flip-flop", "multiplier", "block RAM")),
            *percents,
            design.clocks_after_samples,
            timing.clock_mhz,
            f"{design.clocks_after_samples / timing.clock_mhz:.2f}",
            f"{timing.clock_mhz * 1e6 / design.interval:,.0f}",
        ]
        rows.append(row)
    return markdown(heads, rows)


@cache
def twins_by_block() -> dict[str, list[tuple[Block, str]]]:
    """For each block its twins in every scene and every case of a bench, with their precisions."""
    found: dict[str, list[tuple[Block, str]]] = {}
    with TemporaryDirectory() as folder:
        for scene in chain(scenes(), (case_scene(name, Path(folder)) for name in CASES)):
            for block in walk(scene.twin()):
                found.setdefault(block.block, []).append((block, scene.precision.name))
    return found


def range_text(numbers: Iterable[int]) -> str:
    low, *_, high = sorted([*numbers] * 2)
    return str(low) if low == high else f"{low} to {high}"


def kinds_text(kinds: set[Fix | Unsigned]) -> str:
    """The formats, or the widths of more than two unsigned ones."""
    if len(kinds) > 2 and not any(isinstance(kind, Fix) for kind in kinds):
        return f"{range_text(kind.width for kind in kinds)} bits"
    return " or ".join(sorted(map(str, kinds)))


def port_table(twins: list[tuple[Block, str]]) -> str:
    """The ports of every entity of a block. The ports of a group share a row.

    A format stands with its precision, if no other precision has it.
    """
    rows: dict[str, tuple[Port, dict[str, set[Fix | Unsigned]]]] = {}
    for port, precision in (
        (port, precision) for block, precision in twins for port in block.ports
    ):
        _, kinds = rows.setdefault(port.row, (port, {}))
        if port.kind:
            kinds.setdefault(precision, set()).add(port.kind)
    table = []
    for name, (port, kinds) in rows.items():
        every = set().union(*kinds.values())
        if len(kinds) > 1 and sum(map(len, kinds.values())) == len(every):
            text = "; ".join(f"{precision}: {kinds_text(of)}" for precision, of in kinds.items())
        else:
            text = kinds_text(every) if every else ""
        kind = "std_logic" if not every else "signed" if port.signed else "unsigned"
        table.append([f"`{name}`", port.direction, kind, text, port.meaning])
    return markdown("port | direction | type | format | meaning", table)


def clocks(twins: list[tuple[Block, str]]) -> tuple[str, str]:
    """The latency and the interval, in every design."""
    return range_text(one.latency for one, _ in twins), range_text(one.interval for one, _ in twins)


def purpose(twin: Block) -> str:
    """The first line of the twin's module, without the name of the block."""
    module = importlib.import_module(f"golden.{twin.area}.{twin.block}")
    line = (inspect.getdoc(module) or "").partition("\n")[0].removesuffix(".")
    return line.partition(": ")[2] or line


def block_table() -> str:
    lines = [
        "Latency and interval are in clocks. They are ranges over the shipped scenes, the scenes",
        "for comparison and the cases of the benches. Each datasheet says what they depend on. The",
        "interval is the least number of clocks from one input to the next, or for a network from",
        "one frame to the next.",
        "",
    ]
    by_area = sorted(twins_by_block().items(), key=lambda item: item[1][0][0].area)
    rows = []
    for name, twins in by_area:
        twin, _ = twins[0]
        if not twin.part_of:
            link, section = f"[{name}](blocks/{name}.md)", twin.section or "none"
            rows.append([link, twin.area, purpose(twin), section, *clocks(twins)])
    return "\n".join(
        [*lines, markdown("block | area | what it does | thesis | latency | interval", rows)]
    )


@cache
def sections() -> dict[str, str]:
    """For each block what is published, measured and proved of it, as sections of its datasheet."""
    cells = block_tables()
    return {
        name: "\n\n".join(
            f"## {title}\n\n{text}"
            for title, text in (
                ("Ports", port_table(twins)),
                ("Clocks", markdown("latency, clocks | interval, clocks", [clocks(twins)])),
                ("Cells", cells.get(name, "")),
                ("Sign-off", sheet(name)),
            )
            if text
        )
        for name, twins in twins_by_block().items()
        if not twins[0][0].part_of
    }
