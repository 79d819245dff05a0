"""The table of blocks, and the sections of each block's page, which the site shows.

Formats and clocks are those of every scene, and of every case of a bench.
"""

import importlib
import inspect
from collections.abc import Iterator
from functools import cache
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory

from golden.common.block import Block, walk
from golden.common.port import Port, Unsigned
from golden.numbers.fixed import Fix
from golden.numbers.precision import PRECISIONS
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


AREAS = (
    "activation",
    "layers",
    "networks",
    "engine",
    "sensing",
    "visualisation",
    "link",
    "instruments",
)

# The twins of one block, for each precision by its name.
Twins = dict[str, list[Block]]


@cache
def twins_by_block() -> dict[str, Twins]:
    """For each block its twins in every scene and every case of a bench, the innermost first."""
    found: dict[str, Twins] = {}
    with TemporaryDirectory() as folder:
        for scene in chain(scenes(), (case_scene(name, Path(folder)) for name in CASES)):
            for block in walk(scene.twin()):
                twins = found.setdefault(block.block, {name: [] for name in PRECISIONS})
                twins[scene.precision.name].append(block)
    return found


def by_precision(texts: dict[str, str]) -> str:
    """One text, or a text for each precision if they differ."""
    if len(set(texts.values())) == 1:
        return next(iter(texts.values()))
    return "; ".join(f"{text} in `{name}`" for name, text in texts.items())


def numbers_text(found: dict[str, set[int]]) -> str:
    """A number for each precision, or a range if it depends on more than the precision."""
    if all(len(numbers) == 1 for numbers in found.values()):
        return by_precision({name: str(*numbers) for name, numbers in found.items()})
    every = set().union(*found.values())
    return f"{min(every)} to {max(every)}"


def kinds_text(found: dict[str, set[Fix | Unsigned]]) -> str:
    """A format for each precision, or the widths of unsigned formats that depend on more."""
    every = set().union(*found.values())
    if len(every) > len(found) and not any(isinstance(kind, Fix) for kind in every):
        return f"{numbers_text({'': {kind.width for kind in every}})} bits"
    return by_precision(
        {name: " or ".join(sorted(str(kind) for kind in kinds)) for name, kinds in found.items()}
    )


def port_table(twins: Twins) -> str:
    """The ports of every entity of a block. The ports of a group share a row."""
    rows: dict[str, dict[str, list[Port]]] = {}
    for precision, blocks in twins.items():
        for port in (port for block in blocks for port in block.ports):
            rows.setdefault(port.row, {}).setdefault(precision, []).append(port)
    table = []
    for name, found in rows.items():
        port = next(iter(found.values()))[0]
        kind, text = "std_logic", ""
        if port.kind is not None:
            kind = "signed" if port.signed else "unsigned"
            text = kinds_text(
                {name: {p.kind for p in ports if p.kind} for name, ports in found.items()}
            )
        table.append([f"`{name}`", port.direction, kind, text, port.meaning])
    return markdown("port | direction | type | format | meaning", table)


def clocks(twins: Twins, name: str) -> str:
    """The latency or the interval, as ``name`` says, in every design."""
    return numbers_text(
        {
            precision: {getattr(block, name) for block in blocks}
            for precision, blocks in twins.items()
            if blocks
        }
    )


def _both(twins: Twins) -> tuple[str, str]:
    return clocks(twins, "latency"), clocks(twins, "interval")


def purpose(twins: Twins) -> str:
    """The first line of the twin's module, without the name of the block."""
    twin = next(block for blocks in twins.values() for block in blocks)
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
    rows = []
    for area in AREAS:
        for name, twins in twins_by_block().items():
            twin = next(block for blocks in twins.values() for block in blocks)
            if twin.area == area and not twin.part_of:
                row = [
                    f"[{name}](blocks/{name}.md)",
                    area,
                    purpose(twins),
                    twin.section or "none",
                    *_both(twins),
                ]
                rows.append(row)
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
                ("Clocks", markdown("latency, clocks | interval, clocks", [_both(twins)])),
                ("Cells", cells.get(name, "")),
                ("Sign-off", sheet(name)),
            )
            if text
        )
        for name, twins in twins_by_block().items()
        if not next(block for blocks in twins.values() for block in blocks).part_of
    }
