"""``python -m hdl.synth.lean SCENE``: what a scene leaves out, and what that saves.

The scene is built twice: whole, with every segment of every activation and every hidden node, and
as it is. Those of ``--beside`` are built as they are, to compare with.
"""

from __future__ import annotations

import argparse

from golden.cli import words, would
from golden.progress import Progress
from golden.scene import load_scene
from hdl.export.repeatable import run_repeatable
from hdl.synth.activations import cells
from hdl.synth.cells import FAMILIES
from hdl.synth.netlist import KINDS

FAMILY = "xc2v"


def main() -> None:
    parser = argparse.ArgumentParser(prog="make lean", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--beside", default="", help="scenes, quoted as for a shell")
    arguments = parser.parse_args()
    names = [arguments.scene, *words("BESIDE", arguments.beside)]
    scenes = [load_scene(name) for name in names]
    first = scenes[0]
    would(f"synthesise {', '.join(scene.name for scene in scenes)} and print what is saved")
    print(f"scene {first.name} leaves out:")
    for text in first.twin().left_out():
        print(f"  {text}")
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
    run_repeatable("hdl.synth.lean", main)
