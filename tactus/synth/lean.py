"""``make lean``: shows what a scene leaves out, and what that saves.

The scene is built twice: whole, with every segment of every activation and every hidden node, and
as it is. The scenes of ``--beside`` are built as they are, for comparison.
"""

import tempfile
from pathlib import Path

from golden.common.block import Block
from tactus.core.cli import stop_if_dry_run, words
from tactus.core.commands import arguments_of
from tactus.core.progress import Progress
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.scene import Scene, load_scene
from tactus.synth.cells import FAMILIES, KINDS, synthesise

FAMILY = "xc2v"


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
