"""``make demo``: runs scenes from end to end and prints the results in one table.

Every block of a scene is simulated under GHDL and Icarus on the exported files, and compared with
its twin. Then the errors on the recorded vectors are printed, with the clocks and the speed of the
simulators. Without a scene the default scenes are run, and a table shows them side by side. If
entities of one block differ only in their constants, one of them has a simulation of its own, and
all are simulated within their networks; see ``tactus.verify.benches.results.chosen``. ``--full``
simulates each by itself. A bench that has passed and has not changed since is not run again, even
if an earlier demo was interrupted.
"""

import sys
import textwrap
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import closing
from tactus.core.progress import stage
from tactus.errors import (
    disturbed_errors,
    held_out_means,
    held_out_text,
    lines_of,
    noises_of,
    scene_errors,
    unit_errors,
)
from tactus.report.page.build import build_report
from tactus.report.page.side_by_side import side_by_side
from tactus.scene import DEFAULT_SCENES, Scene, thesis_figures
from tactus.scene.codes import hidden_saturations, quantised_lines, range_lines, ranges
from tactus.scene.disturbance import Disturbance
from tactus.scene.metrics import millimetres
from tactus.scene.vectors import warn_outside
from tactus.train.split import unused_text
from tactus.verify.benches.results import left_texts, simulate
from tactus.verify.benches.runner import ready_scene
from tactus.verify.benches.tools import SIMULATORS, language, simulator_versions
from tactus.verify.every_frame.verdict import DIFFERS, SAID
from tactus.verify.prove import proof_line


def twin_speed(scene: Scene) -> float:
    """How many frames per second the bit-true numpy twin computes on one core."""
    design = scene.twin().core
    codes = np.tile(scene.vectors().codes, (200, 1))
    started = time.perf_counter()
    design.process(codes)
    return len(codes) / (time.perf_counter() - started)


def error_table(scene: Scene) -> list[str]:
    """The errors of every output, in real arithmetic and in the hardware.

    These are the mean, the largest mean over the positions, the worst frame, the mean on rows that
    the networks have not seen, and the mean with noise.
    """
    found, held_out = scene_errors(scene), held_out_means(scene)
    triple = "  mean  largest  worst"
    columns = [(f"{kind:^22}", f"{triple:22}") for kind in ("float", "bit-true")]
    cells = [
        [f"{e.mean:6.2f} {e.largest_mean:8.2f} {e.worst:6.2f}" for e in found[kind]]
        for kind in ("float", "bit-true")
    ]
    single: list[tuple[str, str, list[float]]] = []
    if held_out:
        single.append(("held out", "mean", held_out))
    for noise in noises_of(scene):
        single.append(("noise", f"{noise:g}", disturbed_errors(scene, Disturbance(noise))))
    if scene.reference:
        printed = thesis_figures(scene.reference, len(scene.outputs), scene.path)
        single.append(("thesis", "largest", printed))
    for name, what, errors in single:
        width = max(len(name), len(what))
        columns.append((f"{name:>{width}}", f"{what:>{width}}"))
        cells.append([f"{error:{width}.2f}" for error in errors])
    heads = zip(*columns, strict=True)
    names = ["", "output", *scene.outputs]
    lines = [*heads, *zip(*cells, strict=True)]
    wide = max(9, *map(len, scene.outputs))
    return [
        f"{name:{wide}} {'  '.join(line)}".rstrip() for name, line in zip(names, lines, strict=True)
    ]


def clock_lines(scene: Scene, clocks: int, interval: int) -> list[str]:
    """The clocks of a frame and between frames, and these times at the clock of the scene."""
    return [
        f"clocks a frame            {clocks}, first sample in to last output out "
        f"({clocks / scene.clock_mhz:.3f} us at {scene.clock_mhz:g} MHz)",
        f"clocks between frames     {interval} "
        f"({scene.clock_mhz * 1e6 / interval:,.0f} frames a second)",
    ]


def length_lines(scene: Scene) -> list[str]:
    """The bit-true errors of lengths in millimetres, and of outputs with a scale in their unit."""
    found = scene_errors(scene)["bit-true"]
    lines = []
    for name, error in zip(scene.outputs, found, strict=True):
        if name in scene.length_mm:
            mm = millimetres(error, scene.length_mm[name])
            lines.append(
                f"{name + ' in mm':26}mean {mm.mean:.2f}, largest {mm.largest_mean:.2f}, "
                f"worst {mm.worst:.2f}"
            )
    for name, error in unit_errors(scene).items():
        unit = scene.units.get(name, "its unit")
        lines.append(
            f"{name + ' in ' + unit:26}mean {error.mean:.3g}, largest {error.largest_mean:.3g}, "
            f"worst {error.worst:.3g}"
        )
    return lines


def report(scene: Scene, results: dict[str, Any]) -> str:
    vectors, design = scene.vectors(), scene.twin().core
    facts = results["facts"]
    first = next(iter(facts.values()))
    clocks, interval = first["clocks_per_frame"], first.get("interval", design.interval)
    errors_of_classes = []
    if scene.labels:
        errors_of_classes = [
            "the error of a class is the part of the frames decided wrongly about it"
        ]
    lines = [
        "",
        f"scene {scene.name}: {scene.arrangement} {scene.describe()}, {scene.hidden_text()}, "
        f"{scene.precision.name} precision",
        f"errors in % on {len(vectors.codes)} recorded frames; 'largest' is the largest mean over "
        "the positions",
        *errors_of_classes,
        *textwrap.wrap(unused_text(scene), 100),
        *textwrap.wrap(f"held-out frames: {held_out_text(scene)}", 100),
        "'noise' is the mean with so much noise on every reading, in its unit",
        "",
        *error_table(scene),
        "",
        *(lines_of(scene) if scene.labels else []),
        *length_lines(scene),
        *clock_lines(scene, clocks, interval),
        *(f"{design.entity:25} {fact}" for fact in design.facts()),
        f"samples saturated         {vectors.saturated} of {vectors.samples}",
        *ranges(scene),
        *range_lines(scene, hidden_saturations(scene, vectors.codes)),
        *quantised_lines(scene),
        *(f"left out                  {text}" for text in scene.twin().left_out()),
        "",
        "frames a second, simulated: "
        + ", ".join(f"{s} {f['frames'] / f['seconds']:,.3g}" for s, f in facts.items())
        + f", numpy twin {twin_speed(scene):,.0f}",
    ]
    return "\n".join(lines)


def bench_table(scene: Scene, results: dict[str, Any]) -> str:
    """The numbers of entities and of compared values, one line for each block."""
    lines = [
        "",
        f"scene {scene.name}",
        f"{'block':20} " + "  ".join(f"{s + ' entities, compared':>28}" for s in SIMULATORS),
    ]
    for block, cells in results["blocks"].items():
        columns = [f"{cells[s][0]:18} {cells[s][1]:9}" for s in SIMULATORS]
        lines.append(f"{block:20} " + "  ".join(columns))
    kept = f"{results['kept']} unchanged since they passed and not run again"
    lines.append(
        f"{results['benches']} benches ({kept}), {results['failed']} failed, "
        f"{results['compared']} values compared bit for bit"
    )
    lines += [line for text in left_texts(results) for line in textwrap.wrap(text, 100)]
    return "\n".join(lines)


def main() -> int:
    arguments = arguments_of("demo", __doc__)
    started = time.perf_counter()
    names = DEFAULT_SCENES if arguments.scene is None else (arguments.scene,)
    with stage(f"demo: reading {' and '.join(names)}"):
        scenes = [ready_scene(name) for name in names]
    stop_if_dry_run(f"simulate, export and report {' and '.join(scene.name for scene in scenes)}")
    with held(BUILD / scene.name for scene in scenes):
        code = demonstrate(scenes, arguments.full)
    if code == 0:
        print("\n".join(["", *closing(time.perf_counter() - started, **simulator_versions())]))
    return code


def demonstrate(scenes: Sequence[Scene], full: bool) -> int:
    """Simulate, export and report scenes, and return the exit code."""
    results = {}
    for scene in scenes:
        warn_outside(scene)
        results[scene.name] = simulate(scene, full)
        print(bench_table(scene, results[scene.name]))
    if any(found["failed"] for found in results.values()):
        return 1
    for scene in scenes:
        with stage(f"{scene.name}: measuring errors and speed"):
            text = report(scene, results[scene.name])
        print(text)
        with stage(f"{scene.name}: proving every frame"):
            proof = str(proof_line(scene, ask=True))
        print(f"Verilog, {proof}")
        if proof.startswith(SAID[DIFFERS]):
            return 1
        for simulator in SIMULATORS:
            print(f"{language(simulator):8} in {BUILD / scene.name / language(simulator)}")
        build_report(scene)
    if len(scenes) > 1:
        print("\n".join(["", *side_by_side(scenes, results)]))
    return 0


if __name__ == "__main__":
    sys.exit(run(main))
