"""How many frames a second each simulator computes, all on the same frames."""

import dataclasses

import numpy as np

from tactus.errors.scene_errors import scene_errors
from tactus.report.measure.table import Cell, Table
from tactus.report.measure.timing import timed
from tactus.scene import Scene, load_scene
from tactus.verify.benches.myhdl_simulation import simulate
from tactus.verify.benches.runner import Job, Outcome, plan, run_job
from tactus.verify.benches.tools import SIMULATORS, version
from tactus.verify.sign_off.netlist import NETLISTS_RUN_IN, on_cells

MANY = 1_000_000
# The recorded table is of the default scene, and of the family that its cells are counted for.
SCENE, FAMILY = "digit", "virtex-2"


def simulators(_: int) -> Table:
    """Every simulator, and the netlist, on the recorded frames of the default scene."""
    return compare_simulators(load_scene(SCENE), netlist=True)


def compare_simulators(scene: Scene, netlist: bool = False) -> Table:
    """Floating point, bit-true numpy, MyHDL, Icarus and GHDL on a scene's recorded frames.

    netlist: Whether the netlist of Virtex-II cells is simulated, too.
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

    def play(name: str, job: Job) -> None:
        outcome = _passed(name, job)
        facts = outcome.facts
        add(f"{name}, cocotb", "bit-true", facts["frames"], facts["seconds"], outcome.compared)

    for simulator in reversed(SIMULATORS):
        jobs = plan(scene, [simulator], design.block)
        (job,) = (j for j in jobs if j.entity == design.entity)
        job = dataclasses.replace(job, test="recorded")
        name = version(simulator).split(" (")[0]
        play(name, job)
        if netlist and simulator == NETLISTS_RUN_IN:
            play(f"{FAMILY} netlist, {name}", on_cells(job, FAMILY))
    return Table(
        "simulators",
        [
            "simulator",
            "frames",
            "seconds",
            "frames a second",
            "mean error %, worst output",
            "values compared, all equal",
        ],
        rows,
        f"The {len(codes)} recorded frames of scene {scene.name} run through {design.entity}, as "
        "close together as it takes them. In numpy all frames run at once, and also repeated to a "
        "million. The times do not include elaboration and compilation, but they include driving "
        "and recording by cocotb. The bench compares the results of GHDL and Icarus, and any "
        "difference fails the report.",
        timed=["seconds", "frames a second"],
    )


def _passed(name: str, job: Job) -> Outcome:
    outcome = run_job(job)
    if not outcome.passed:
        raise RuntimeError(f"{job.entity}, {name}: {outcome.complaint()}")
    return outcome
