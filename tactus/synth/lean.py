"""``python -m tactus.synth.lean SCENE``: show what a scene leaves out, and what that saves.

The scene is built twice: whole, with every segment of every activation and every hidden node, and
as it is. The scenes of ``--beside`` are built as they are, for comparison. ``--record`` keeps the
cells of both builds for docs/left-out.md.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path

from golden.common.block import Block
from golden.input_error import InputError
from tactus.core.cli import run_repeatable, stop_if_dry_run, words
from tactus.core.commands import arguments_of
from tactus.core.progress import Progress
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.scene import Scene, load_scene
from tactus.synth.budget import (
    LEAN,
    TIMING,
    is_recorded,
    read_budget,
    read_rows,
    table_of,
    write_rows,
)
from tactus.synth.cells import FAMILIES, KINDS, synthesise
from tactus.synth.timing import read_timing

FAMILY = "xc2v"
COLUMNS: dict[str, type] = {f"{kind}, {how}": int for how in ("whole", "lean") for kind in KINDS}
COLUMNS |= {"verilog": str}


@dataclass(frozen=True)
class Lean:
    """The cells of a scene, whole and as it is, as ``--record`` found them.

    verilog: The digest of the scene's Verilog as ``make synth`` recorded it. The record is stale
        when that is another one.
    whole, lean: Counts in FAMILY, by the kind of cell.
    """

    verilog: str
    whole: dict[str, int]
    lean: dict[str, int]


def read_lean(scene: Path) -> Lean:
    ((*cells, verilog),) = read_rows(scene, LEAN, COLUMNS)
    whole, lean = cells[: len(KINDS)], cells[len(KINDS) :]
    return Lean(verilog, *(dict(zip(KINDS, c, strict=True)) for c in (whole, lean)))


def record(scene: Scene) -> Path:
    """Record the cells of a scene: whole, and as ``make synth`` recorded them."""
    if not is_recorded(scene.path, TIMING) or not is_recorded(scene.path):
        raise InputError(
            f"{scene.path}: no recorded budget; make synth RECORD=1 SCENE={scene.path} records it"
        )
    verilog, lean = synthesised(scene)
    design = scene.twin(lean=False)
    whole = lean if design == scene.twin() else cells(design, FAMILY)
    row = [*(build[kind] for build in (whole, lean) for kind in KINDS), verilog]
    write_rows(scene.path, LEAN, COLUMNS, [row])
    return table_of(scene.path, LEAN)[0]


def synthesised(scene: Scene) -> tuple[str, dict[str, int]]:
    """The digest and the cells that ``make synth`` recorded."""
    top = read_budget(scene.path)[FAMILY][scene.twin().entity]
    return read_timing(scene.path)[1], {kind: top[kind] for kind in KINDS}


def main() -> None:
    arguments = arguments_of("lean", __doc__)
    names = [arguments.scene, *words("BESIDE", arguments.beside)]
    scenes = [load_scene(name) for name in names]
    first = scenes[0]
    stop_if_dry_run(
        f"synthesise {', '.join(scene.name for scene in scenes)} and print what is saved"
    )
    print(f"scene {first.name} leaves out:")
    for text in first.twin().left_out():
        print(f"  {text}")
    if arguments.record:
        print(f"wrote {record(first)}")
        return
    compare(scenes)


def compare(scenes: list[Scene]) -> None:
    """Print the cells of the first scene whole and as it is, and of the others as they are."""
    first = scenes[0]
    rows: list[tuple[str, dict[str, int]]] = []
    with Progress("synthesising", 1 + len(scenes), "designs") as progress:
        whole = cells(first.twin(lean=False), FAMILY)
        rows.append((f"{first.name}, whole", whole))
        progress.step(first.name)
        for scene in scenes:
            found = cells(scene.twin(), FAMILY)
            rows.append((scene.name, found))
            if scene is first:
                rows.append(("saved", {kind: whole[kind] - found[kind] for kind in KINDS}))
            progress.step(scene.name)
    print(f"\n{FAMILIES[FAMILY]} (synth_xilinx -family {FAMILY})")
    print(f"{'':32}" + "".join(f"{kind:>12}" for kind in KINDS))
    for name, found in rows:
        print(f"{name:32}" + "".join(f"{found[kind]:12}" for kind in KINDS))


def cells(spec: Block, family: str) -> dict[str, int]:
    with tempfile.TemporaryDirectory() as name:
        convert_hierarchy(elaborate(spec), Path(name), "verilog")
        return synthesise(Path(name), spec.entity, family)[spec.entity]


if __name__ == "__main__":
    run_repeatable("tactus.synth.lean", main)
