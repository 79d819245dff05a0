"""The recorded cells of every scene, and those of one block for its page."""

from collections.abc import Iterator

from golden.common.block import walk
from tactus.report.measure.table import markdown
from tactus.scene import Scene, load_scene, scene_names
from tactus.synth.budget import Cells, read_budget, shares
from tactus.synth.cells import DEPTH, FAMILIES, FLAT_FAMILY, KINDS, flat_name
from tactus.synth.timing import read_timing

# These are the networks of section 5.2.2, and the forms of an engine without a shipped scene.
COMPARED = [
    *(f"digit-parallel-{name}" for name in ("lut", "pade", "polynomial")),
    *("digit-fast-clock", "digit-fast-full", "digit-fast-ternary"),
    *("digit-lanes2", "digit-lanes4", "digits-lanes8"),
    *("digit-single-engine", "digit-single-fast"),
    *("digit-sums", "digit-tables", "wine-tables"),
    *("swing-single-thesis", "swing-multiple-thesis", "swing-cascade-thesis", "thesis-larger"),
]
COLUMNS = [*KINDS, DEPTH]


def recorded() -> Iterator[tuple[Scene, Cells]]:
    """Every scene that has a budget, with its budget."""
    names = [*scene_names(), *(f"comparison/{n}" for n in COMPARED)]
    for name in names:
        scene = load_scene(name)
        yield scene, read_budget(scene.path)


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
            *(found[column] for column in COLUMNS),
        ]
        for family, (_, scene, entity, found) in best.items()
    ]
    return (
        "For each family, the table shows the entity of this block with the most LUTs in any\n"
        "scene, with its parts included (`make synth`):\n\n"
        + markdown(" | ".join(["family | scene, entity", *COLUMNS]), rows)
    )


def scene_table() -> str:
    """A table with a line for each scene: cells, shares of the thesis' device, and clock."""
    heads = (
        "scene | LUT, entity by entity | LUT, in one piece | flip-flop | multiplier | block RAM | "
        "depth | % LUTs (thesis) | % multipliers (thesis) | clocks | ECP5 MHz | us | "
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
            *(top[kind] for kind in ("flip-flop", "multiplier", "block RAM", DEPTH)),
            *percents,
            design.output_clocks[-1],
            timing.clock_mhz,
            f"{design.output_clocks[-1] / timing.clock_mhz:.2f}",
            f"{timing.clock_mhz * 1e6 / design.interval:,.0f}",
        ]
        rows.append(row)
    return markdown(heads, rows)
