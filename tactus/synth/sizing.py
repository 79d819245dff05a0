"""``python -m tactus.cli.call tactus.synth.sizing``: records the cells for the estimates.

``tactus/sizing/cells.csv`` gets the cells of the networks that ``make synth`` recorded, and of
other designs of the same networks, beside the numbers from which ``tactus.sizing.model`` estimates
them.
"""

import tempfile
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

from golden.input_error import InputError
from golden.networks.adder_graph import OPTIONS as DEFAULTS
from golden.networks.network import Network
from golden.networks.windowed import Windowed
from tactus.core.cli import stop_if_dry_run
from tactus.core.table import write_csv_file
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.network_files.parsed import file_of
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
from tactus.sizing.features import IN_ONE_PIECE, features_of
from tactus.sizing.model import CELLS, COLUMNS, Recorded, Size, path_of
from tactus.synth.budget import Cells, is_recorded, read_budget
from tactus.synth.cells import flat_name, synthesise, synthesise_flat
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
        return f"{self.scene}, {self.candidate.name}"

    def built(self) -> tuple[Scene, Network]:
        scene = load_scene(self.scene)
        return scene, build(task_of(scene), self.candidate)


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
    scene, core = extra.built()
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


def row_of(
    name: str, scene: Scene, core: Network, cells: Cells, candidate: Candidate | None = None
) -> Recorded:
    """The cells of a network, beside what its twin says of it.

    ``candidate`` is its design; without it, the scene's, and the scene may have been routed.
    """
    design = candidate.design if candidate else scene.design
    options = candidate.options if candidate else {**DEFAULTS, **scene.design_options}
    kind, routed = kind_of(design, options), None
    if not candidate and scene.twin() == core and not scene.argmax:
        timing, _ = read_timing(scene.path)
        routed = Size(timing.luts, timing.flip_flops, timing.clock_mhz)
    features = features_of(core)
    own = (whole_cells(cells[FAMILY], core, cell) for cell in ("LUT", "flip-flop"))
    weights = file_of(scene.weights_paths[0]).stem
    return Recorded(name, weights, kind, path_of(kind, options), Size(*own), routed, features)


def whole_cells(found: dict[str, dict[str, int]], core: Network, cell: str) -> int:
    """How many cells of a kind a network has, without what finds the largest output."""
    if core.block in IN_ONE_PIECE:
        whole = flat_name(core.entity)
        if whole not in found:
            raise InputError(f"{core.entity}: got no synthesis in one piece, as inside of others")
        return found[whole][cell]
    beside = [part.entity for part in core.parts() if part.block in LEFT_OUT]
    return found[core.entity][cell] - sum(found[entity][cell] for entity in beside)


def record() -> list[Recorded]:
    """The rows of the file. A network with a block that has no model is left out."""
    rows = []
    for name, scene, core, cells in networks():
        try:
            rows.append(row_of(name, scene, core, cells))
        except InputError as error:
            print(f"{name}: left out: {error}")
    for extra in EXTRAS:
        print(extra.name, flush=True)
        rows.append(row_of(extra.name, *synthesised(extra), extra.candidate))
    return rows


def written(row: Recorded) -> list[object]:
    placed = astuple(row.routed) if row.routed else ("", "", "")
    features = " ".join(f"{name}={number}" for name, number in sorted(row.features.items()))
    size = row.size.luts, row.size.flip_flops
    return [row.network, row.weights, row.design, row.path, *size, *placed, features]


def main() -> None:
    stop_if_dry_run("synthesise networks and record their cells")
    write_csv_file(CELLS, [COLUMNS, *map(written, record())])
    print(f"wrote {CELLS}")
