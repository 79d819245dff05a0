"""``make demo``: runs scenes from end to end and prints the results in one table.

Every block of a scene is simulated under GHDL and Icarus on the exported files, and compared with
its twin. Then the errors on the recorded vectors are printed, with the clocks and the speed of the
simulators. Without a scene the default scenes are run, and a table shows them beside the thesis. If
entities of one block differ only in their constants, one of them has a simulation of its own, and
all are simulated within their networks; see ``tactus.verify.benches.results.chosen``. A bench that
has passed and has not changed since is not run again, even if an earlier demo was interrupted.
"""

import textwrap
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import closing
from tactus.core.progress import stage
from tactus.report.page.build import build_report
from tactus.report.page.content import bench_table
from tactus.report.page.headline import headline
from tactus.scene import DEFAULT_SCENES, Scene
from tactus.scene.vectors import warn_outside
from tactus.verify.benches.results import simulate
from tactus.verify.benches.runner import ready_scene
from tactus.verify.benches.tools import SIMULATORS, language, simulator_versions
from tactus.verify.every_frame.verdict import DIFFERS, PROVED, SAID
from tactus.verify.prove import proof_line


def speeds(scene: Scene, results: dict[str, Any]) -> str:
    """The frames a second of each simulator, and of the bit-true numpy twin on one core."""
    simulated = (f"{s} {f['frames'] / f['seconds']:,.3g}" for s, f in results["facts"].items())
    design, codes = scene.twin().core, np.tile(scene.vectors().codes, (200, 1))
    started = time.perf_counter()
    design.process(codes)
    twin = f"numpy twin {len(codes) / (time.perf_counter() - started):,.0f}"
    return f"frames a second, simulated: {', '.join([*simulated, twin])}"


def bench_lines(scene: Scene, results: dict[str, Any]) -> list[str]:
    kept = f"{results['kept']} unchanged since they passed and not run again"
    return [
        "",
        f"scene {scene.name}",
        *bench_table(results).lines(),
        f"{results['benches']} benches ({kept}), {results['failed']} failed, "
        f"{results['compared']} values compared bit for bit",
        *(line for text in results["left_out"] for line in textwrap.wrap(text, 100)),
    ]


def main() -> int:
    arguments = arguments_of("demo", __doc__)
    started = time.perf_counter()
    names = DEFAULT_SCENES if arguments.scene is None else (arguments.scene,)
    with stage(f"demo: reading {' and '.join(names)}"):
        scenes = [ready_scene(name) for name in names]
    stop_if_dry_run(f"simulate, export and report {' and '.join(scene.name for scene in scenes)}")
    with held(BUILD / scene.name for scene in scenes):
        code = demonstrate(scenes)
    if code == 0:
        print("\n".join(["", *closing(time.perf_counter() - started, **simulator_versions())]))
    return code


def demonstrate(scenes: Sequence[Scene]) -> int:
    """Simulate, export and report scenes, and return the exit code."""
    results = {}
    for scene in scenes:
        warn_outside(scene)
        results[scene.name] = simulate(scene)
        print("\n".join(bench_lines(scene, results[scene.name])))
    if any(found["failed"] for found in results.values()):
        return 1
    proved = []
    for scene in scenes:
        with stage(f"{scene.name}: proving every frame"):
            proof = str(proof_line(scene, ask=True))
        print(f"Verilog, {proof}")
        if proof.startswith(SAID[DIFFERS]):
            return 1
        proved.append(proof.startswith(SAID[PROVED]))
        for simulator in SIMULATORS:
            print(f"{language(simulator):8} in {BUILD / scene.name / language(simulator)}")
        told = ["", *build_report(scene).lines(), ""]
        told += [f"left out: {text}" for text in scene.twin().left_out()]
        print("\n".join([*told, speeds(scene, results[scene.name])]))
    if len(scenes) > 1:
        print("\n".join(["", *headline(tuple(proved)).lines()]))
    return 0
