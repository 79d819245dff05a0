"""``python -m tactus.synth.lean SCENE``: show what a scene leaves out, and what that saves.

The scene is built twice: whole, with every segment of every activation and every hidden node, and
as it is. The scenes of ``--beside`` are built as they are, for comparison. ``--record`` keeps the
cells of both builds beside the scene, for docs/left-out.md.
"""

import argparse
from dataclasses import asdict, dataclass
from pathlib import Path

from golden.input_error import InputError
from golden.networks.left_out import left_out
from tactus.core.cli import stop_if_dry_run, words
from tactus.core.files import read_json, write_json
from tactus.core.progress import Progress
from tactus.export.repeatable import run_repeatable
from tactus.scene import Scene, load_scene
from tactus.synth.activations import cells
from tactus.synth.budget import budget_path, read_budget
from tactus.synth.cells import FAMILIES
from tactus.synth.netlist import KINDS
from tactus.synth.timing import read_timing, timing_path

FAMILY = "xc2v"


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


def lean_path(scene: Path) -> Path:
    """Where the record of a scene stands: beside it."""
    return scene.with_suffix(".lean.json")


def read_lean(path: Path) -> Lean:
    """The recorded cells."""
    return read_json(
        path, "recorded cells; make lean RECORD=1 records them", make=lambda found: Lean(**found)
    )


def is_stale(scene: Scene) -> bool:
    """Whether the record of a scene is of other hardware than ``make synth`` has recorded last."""
    found = read_lean(lean_path(scene.path))
    return (found.verilog, found.lean) != _synthesised(scene)


def record(scene: Scene) -> Path:
    """Keep the cells of a scene beside it: whole, and as ``make synth`` recorded them."""
    if not timing_path(scene.path).is_file() or not budget_path(scene.path).is_file():
        raise InputError(
            f"{scene.path}: no recorded budget; make synth RECORD=1 SCENE={scene.path} records it"
        )
    verilog, lean = _synthesised(scene)
    design = scene.twin(lean=False)
    whole = lean if design == scene.twin() else cells(design, FAMILY)
    path = lean_path(scene.path)
    write_json(path, asdict(Lean(verilog, {kind: whole[kind] for kind in KINDS}, lean)))
    return path


def _synthesised(scene: Scene) -> tuple[str, dict[str, int]]:
    """The digest and the cells that ``make synth`` recorded."""
    top = read_budget(budget_path(scene.path))[FAMILY][scene.twin().entity]
    return read_timing(timing_path(scene.path))[1], {kind: top[kind] for kind in KINDS}


def main() -> None:
    parser = argparse.ArgumentParser(prog="make lean", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--beside", default="", help="scenes, quoted as for a shell")
    parser.add_argument("--record", action="store_true", help="keep the cells beside the scene")
    arguments = parser.parse_args()
    names = [arguments.scene, *words("BESIDE", arguments.beside)]
    scenes = [load_scene(name) for name in names]
    first = scenes[0]
    stop_if_dry_run(
        f"synthesise {', '.join(scene.name for scene in scenes)} and print what is saved"
    )
    print(f"scene {first.name} leaves out:")
    for text in left_out(first.twin()):
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


if __name__ == "__main__":
    run_repeatable("tactus.synth.lean", main)
