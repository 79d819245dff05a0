"""Frames a second of every engine on the same frames."""

from __future__ import annotations

import dataclasses

import numpy as np

from golden.errors import scene_errors
from golden.scene import Scene
from tb.common.myhdl_simulation import simulate
from tb.common.runner import plan, run_job
from tb.common.tools import SIMULATORS, version
from tb.report.measure.table import Cell, Table
from tb.report.measure.timing import timed

MANY = 1_000_000


def engines(scene: Scene) -> Table:
    """Float, bit-true numpy, MyHDL, Icarus and GHDL on the scene's recorded frames.

    Raises
    ------
    RuntimeError
        When an engine's results are not those of the twin.
    """
    vectors = scene.vectors()
    design = scene.twin().core
    codes = vectors.codes
    found = scene_errors(scene)
    worst = {kind: max(e.mean for e in errors) for kind, errors in found.items()}
    rows: list[list[Cell]] = []

    def add(name: str, kind: str, count: int, seconds: float, compared: int | None) -> None:
        rows.append([name, count, seconds, count / seconds, worst[kind], compared])

    scene.process_real(vectors.inputs)
    _, ms = timed(scene.process_real, vectors.inputs)
    add("float, numpy", "float", len(codes), ms / 1e3, None)
    twin, _ = timed(design.process, codes)
    _, ms = timed(design.process, codes)
    add("bit-true, numpy", "bit-true", len(codes), ms / 1e3, None)
    _, ms = timed(design.process, np.resize(codes, (MANY, codes.shape[1])))
    add("bit-true, numpy, repeated", "bit-true", MANY, ms / 1e3, None)

    results, seconds = simulate(design, codes)
    if not np.array_equal(results, twin):
        raise RuntimeError(f"{design.entity}: MyHDL and the twin differ")
    add("MyHDL", "bit-true", len(codes), seconds, twin.size)
    for simulator in reversed(SIMULATORS):
        jobs = plan(scene, [simulator], design.block)
        (job,) = (j for j in jobs if j.entity == design.entity)
        outcome = run_job(dataclasses.replace(job, test="recorded"))
        if not outcome.passed:
            raise RuntimeError(f"{design.entity}, {simulator}: {outcome.complaint()}")
        name = f"{version(simulator).split(' (')[0]}, cocotb"
        facts = outcome.facts
        add(name, "bit-true", facts["frames"], facts["seconds"], outcome.compared)
    return Table(
        "engines",
        [
            "engine",
            "frames",
            "seconds",
            "frames a second",
            "mean error %, worst output",
            "values compared, all equal",
        ],
        rows,
        f"The {len(codes)} recorded frames of scene {scene.name} through {design.entity}, as close "
        "as it takes them; in numpy all at once, and repeated to a million. Elaboration and "
        "compilation are left out, cocotb's driving and recording are in. The bench compares what "
        "GHDL and Icarus give; any difference fails the report.",
        timed=["seconds", "frames a second"],
    )
