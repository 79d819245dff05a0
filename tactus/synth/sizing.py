"""``python -m tactus.synth.sizing``: compare estimated cells with recorded ones.

``tactus/sizing/cells.csv`` holds the cells of every block of the networks that ``make synth``
recorded, beside the numbers from which ``tactus.sizing.model`` estimates them; ``--record`` writes
it anew.
"""

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from golden.common.block import Block
from golden.input_error import InputError
from golden.networks.adder_graph import OPTIONS as DEFAULTS
from golden.networks.network import Network
from golden.networks.windowed import Windowed
from tactus.core.cli import run_repeatable, stop_if_dry_run
from tactus.core.table import write_csv_file
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.scene import Scene, load_scene, scene_names
from tactus.scene.building import task_of
from tactus.scene.reading import class_names, comparison_names
from tactus.sizing.candidates import (
    DEEP,
    HYBRID,
    PARALLEL,
    SHORT,
    Candidate,
    adders,
    build,
    kind_of,
    lanes,
    tables,
)
from tactus.sizing.features import IN_ONE_PIECE, Features, features_of, group_of
from tactus.sizing.model import CELLS, COLUMNS, Recorded, held_out, instances, recorded
from tactus.sizing.routed import COLUMNS as PLACED_COLUMNS
from tactus.sizing.routed import ROUTED, Placed, path_of
from tactus.synth.budget import Cells, read_budget
from tactus.synth.cells import flat_name, synthesise, synthesise_flat
from tactus.synth.recorded import is_recorded
from tactus.synth.timing import read_timing

FAMILY = "xc2v"
# The largest output is found beside the networks, which are compared without it.
LEFT_OUT = ("argmax_tree",)


@dataclass(frozen=True)
class Extra:
    """A design of a scene's networks that no scene names, and that is synthesised for the model."""

    scene: str
    candidate: Candidate

    @property
    def name(self) -> str:
        """The scene and the design, as text."""
        return f"{self.scene}, {self.candidate.name}"


TABLES = "comparison/digit-tables"
# The quick ones first. Each design has networks of different weights here, so that all of a network
# can be held out.
EXTRAS = (
    Extra("swing-cascade", DEEP),
    Extra("classes/wine", DEEP),
    Extra("classes/digits-fast", SHORT),
    *(Extra("digit-load", lanes(count)) for count in (2, 4, 8)),
    *(Extra("swing-cascade", lanes(count)) for count in (2, 4)),
    *(Extra("digit-single", lanes(count)) for count in (2, 8, 16)),
    *(Extra("classes/digits", lanes(count)) for count in (2, 4, 16)),
    *(Extra("classes/loads", lanes(count)) for count in (4, 8)),
    Extra("digit-load", HYBRID),
    Extra("swing-single", HYBRID),
    Extra("swing-cascade", HYBRID),
    Extra("swing-multiple", HYBRID),
    Extra("digit-load", PARALLEL),
    Extra("swing-single", PARALLEL),
    Extra("classes/wine", adders(5)),
    Extra("digit-load", adders(2)),
    Extra("swing-single", adders(1)),
    Extra("swing-multiple", adders(5)),
    Extra("classes/loads", adders(2)),
    Extra(TABLES, tables(5, sample_bits=8, hidden_bits=8, output_bits=8)),
    Extra(TABLES, tables(2, sample_bits=9, hidden_bits=10, output_bits=10)),
    Extra(TABLES, tables(5, sample_bits=12, hidden_bits=9, output_bits=12)),
)


def synthesised(extra: Extra) -> tuple[Scene, Network, Cells]:
    """An extra network and its cells, which the store keeps."""
    scene = load_scene(extra.scene)
    core = build(task_of(scene), extra.candidate)
    with tempfile.TemporaryDirectory() as folder:
        convert_hierarchy(elaborate(core), Path(folder), "verilog")
        if core.block in IN_ONE_PIECE:
            found = {flat_name(core.entity): synthesise_flat(Path(folder), core.entity)}
        else:
            found = synthesise(Path(folder), core.entity, FAMILY)
    return scene, core, {FAMILY: found}


def networks() -> Iterator[tuple[str, Scene, Network, Cells]]:
    """Every recorded network without what stands around it, and the cells of its entities."""
    for name in [*scene_names(), *class_names(), *comparison_names()]:
        scene = load_scene(name)
        if is_recorded(scene.path) and not scene.design_options.get("reload"):
            core = scene.twin().core
            while isinstance(core, Windowed):
                core = core.network
            yield name, scene, core, read_budget(scene.path)


def rows_of(name: str, scene: Scene, core: Network, cells: Cells, kind: str = "") -> list[Recorded]:
    """The own cells of each entity of a network, beside what its twin says of it.

    ``kind`` is that of the design; without it, that of the scene's.
    """
    found = cells[FAMILY]
    rows = []
    for block, count in instances(core):
        if block.block in LEFT_OUT:
            continue
        luts, flip_flops = (own_cells(found, block, cell) for cell in ("LUT", "flip-flop"))
        rows.append(
            Recorded(
                name,
                scene.weights_paths[0].stem,
                kind or kind_of(scene.design, scene.design_options),
                block.entity,
                group_of(block),
                count,
                luts,
                flip_flops,
                features_of(block),
            )
        )
    return rows


def own_cells(found: dict[str, dict[str, int]], block: Block, cell: str) -> int:
    """How many cells of a kind an entity has without its parts, or as a whole in one piece."""
    if block.block in IN_ONE_PIECE:
        whole = flat_name(block.entity)
        if whole not in found:
            raise InputError(f"{block.entity}: got no synthesis in one piece, as inside of others")
        return found[whole][cell]
    return found[block.entity][cell] - sum(found[part.entity][cell] for part in block.parts())


def placed_row(name: str, scene: Scene) -> Placed:
    """What ``make synth`` recorded of a network that was placed and routed."""
    timing, _ = read_timing(scene.path)
    return Placed(
        name,
        kind_of(scene.design, scene.design_options),
        path_of(scene.design, {**DEFAULTS, **scene.design_options}),
        timing.luts,
        timing.flip_flops,
        timing.multipliers,
        timing.block_rams,
        timing.clock_mhz,
    )


def record() -> tuple[list[Recorded], list[Placed]]:
    """The rows of both files. A network with a block that has no model is left out."""
    rows: list[Recorded] = []
    placed: list[Placed] = []
    for name, scene, core, cells in networks():
        try:
            rows += rows_of(name, scene, core, cells)
        except InputError as error:
            print(f"{name}: left out: {error}")
            continue
        if scene.twin() == core and not scene.argmax:
            placed.append(placed_row(name, scene))
    for extra in EXTRAS:
        print(extra.name, flush=True)
        scene, core, cells = synthesised(extra)
        kind = kind_of(extra.candidate.design, extra.candidate.options)
        rows += rows_of(extra.name, scene, core, cells, kind)
    # A scene of a study may have no data here.
    rows += [row for row in recorded() if row.network.startswith("studies/")]
    return rows, placed


def cells_of(row: Recorded | Placed) -> list[str]:
    """A row of a CSV."""
    return [cell for value in vars(row).values() for cell in written(value)]


def written(value: object) -> list[str]:
    """The cells of a value: numbers that belong together stand in one."""
    if isinstance(value, Features):
        return [" ".join(map(str, map(int, one))) for one in (value.luts, value.flip_flops)]
    return [str(value)]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tactus.synth.sizing", description=__doc__)
    parser.add_argument("--record", action="store_true")
    asked = parser.parse_args().record
    stop_if_dry_run(
        "synthesise networks and record their cells" if asked else "compare estimated cells"
    )
    if asked:
        rows, placed = record()
        write_csv_file(CELLS, [COLUMNS, *map(cells_of, rows)])
        write_csv_file(ROUTED, [PLACED_COLUMNS, *map(cells_of, placed)])
        print(f"wrote {CELLS} and {ROUTED}")
    print("LUTs of a Virtex-II: recorded, and estimated from networks of other weights")
    for one in held_out():
        print(
            f"{one.network:40}{one.design:16}{one.luts:8}{one.estimated:10.0f}{one.percent:+8.1f} %"
        )


if __name__ == "__main__":
    run_repeatable("tactus.synth.sizing", main)
