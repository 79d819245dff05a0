"""``python -m hdl.synth.sizing``: compare estimated cells with recorded ones.

``golden/sizing/cells.csv`` holds the cells of every block of the networks that ``make synth``
recorded, beside the numbers from which ``golden.sizing.model`` estimates them; ``--record`` writes
it anew.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from golden.cli import run
from golden.files import replace_file
from golden.input_error import InputError
from golden.networks.adder_graph import OPTIONS as DEFAULTS
from golden.networks.network import Network
from golden.networks.windowed import Windowed
from golden.scene import Scene, load_scene, scene_names
from golden.scene.reading import class_names, comparison_names
from golden.sizing.candidates import kind_of
from golden.sizing.features import Features, features_of, group_of
from golden.sizing.model import CELLS, COLUMNS, Recorded, held_out, instances
from golden.sizing.routed import COLUMNS as PLACED_COLUMNS
from golden.sizing.routed import ROUTED, Placed, path_of
from hdl.synth.budget import Cells, budget_path, read_budget
from hdl.synth.timing import read_timing, timing_path

FAMILY = "xc2v"
# The largest output is found beside the networks, which are compared without it.
LEFT_OUT = ("argmax_tree",)


def networks() -> Iterator[tuple[str, Scene, Network, Cells]]:
    """Every recorded network without what stands around it, and the cells of its entities."""
    for name in [*scene_names(), *class_names(), *comparison_names()]:
        scene = load_scene(name)
        path = budget_path(scene.path)
        if path.is_file() and not scene.design_options.get("reload"):
            core = scene.twin().core
            while isinstance(core, Windowed):
                core = core.network
            yield name, scene, core, read_budget(path)


def rows_of(name: str, scene: Scene, core: Network, cells: Cells) -> list[Recorded]:
    """The own cells of each entity of a network, beside what its twin says of it."""
    found = cells[FAMILY]
    rows = []
    for block, count in instances(core):
        if block.block in LEFT_OUT:
            continue
        own = {
            kind: found[block.entity][kind]
            - sum(found[part.entity][kind] for part in block.parts())
            for kind in ("LUT", "flip-flop")
        }
        rows.append(
            Recorded(
                name,
                scene.weights_paths[0].stem,
                kind_of(scene.design, scene.design_options),
                block.entity,
                group_of(block),
                count,
                own["LUT"],
                own["flip-flop"],
                features_of(block),
            )
        )
    return rows


def placed_row(name: str, scene: Scene) -> Placed:
    """What ``make synth`` recorded of a network that was placed and routed."""
    timing, _ = read_timing(timing_path(scene.path))
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
    return rows, placed


def write(path: Path, columns: Sequence[str], rows: Sequence[Recorded | Placed]) -> None:
    """Write rows as a CSV."""
    with (
        replace_file(path) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as handle,
    ):
        writer = csv.writer(handle, lineterminator="\n")
        writer.writerow(columns)
        for row in rows:
            writer.writerow([cell for value in vars(row).values() for cell in written(value)])


def written(value: object) -> list[str]:
    """The cells of a value: numbers that belong together stand in one."""
    if isinstance(value, Features):
        return [" ".join(map(str, map(int, one))) for one in (value.luts, value.flip_flops)]
    return [str(value)]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m hdl.synth.sizing", description=__doc__)
    parser.add_argument("--record", action="store_true")
    if parser.parse_args().record:
        rows, placed = record()
        write(CELLS, COLUMNS, rows)
        write(ROUTED, PLACED_COLUMNS, placed)
        print(f"wrote {CELLS} and {ROUTED}")
    print("LUTs of a Virtex-II: recorded, and estimated from networks of other weights")
    for one in held_out():
        print(
            f"{one.network:40}{one.design:16}{one.luts:8}{one.estimated:10.0f}{one.percent:+8.1f} %"
        )


if __name__ == "__main__":
    sys.exit(run(main))
