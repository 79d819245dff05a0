"""``make sim``: the benches of one block, or of every block of a scene.

Without a scene a block is taken in the first case of its bench, and all blocks in the default
scenes. Benches run on the exported VHDL and Verilog, or on the netlist that ``--netlist`` names
(``tactus/verify/sign_off/netlist.py``).
"""

import argparse
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from golden.common.block import walk
from golden.input_error import InputError
from tactus.core.cli import dry, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.progress import stage
from tactus.scene import DEFAULT_SCENES, Scene, load_scene
from tactus.verify.benches.blocks import check_block
from tactus.verify.benches.collected import CASES_OF, case_scene
from tactus.verify.benches.results import run_and_keep
from tactus.verify.benches.runner import FRAMES, Job, Outcome, plan, run_shown
from tactus.verify.benches.tools import SIMULATORS, check_simulator
from tactus.verify.sign_off.netlist import chosen, mapped, on_cells_of, record
from tactus.verify.sign_off.record import RUNS_IN, case_line, chosen_blocks


def conclude(outcomes: list[Outcome]) -> int:
    failed = sum(not o.passed for o in outcomes)
    compared = sum(o.compared for o in outcomes)
    print(f"{len(outcomes)} benches, {failed} failed, {compared} results compared")
    return 1 if failed else 0


def scenes(named: str | None, block: str | None, build: Path) -> list[Scene]:
    """Where benches run; the scene of a case is written below ``build``."""
    if named is not None:
        scene = load_scene(named)
        check_block(scene, block)
        return [scene]
    if block is not None:
        chosen_blocks(block)
        print(case_line(block), flush=True)
        return [case_scene(CASES_OF[block][0], build)]
    print(f"each block: in the default scenes, {' and '.join(DEFAULT_SCENES)}", flush=True)
    return [load_scene(name) for name in DEFAULT_SCENES]


def main() -> int:
    arguments = arguments_of("sim", __doc__)
    if arguments.record:
        if not arguments.netlist:
            raise InputError("RECORD=1: got no NETLIST, expected 1 or unknown, which is recorded")
        return conclude(record(arguments.netlist, arguments.block))
    families = chosen(arguments.netlist, arguments.sim) if arguments.netlist else []
    simulators = [RUNS_IN] if families else [arguments.sim] if arguments.sim else SIMULATORS
    for simulator in simulators:
        check_simulator(simulator)
    with TemporaryDirectory() as folder:
        # A dry run must not leave the scene of a case behind.
        build = Path(folder) if dry() else BUILD
        found = scenes(arguments.scene, arguments.block, build)
        count = 0
        for scene in found:
            design = scene.twin()
            asked = [p for p in walk(design) if arguments.block in (None, p.block)]
            entities = {p.entity for p in asked if not p.part_of}
            count += len(mapped(design, entities, families or simulators))
        stop_if_dry_run(f"export, then run {count} benches on {', '.join(families or simulators)}")
    with held(BUILD / scene.name for scene in found):
        return simulate(found, list(simulators), families, arguments)


def simulate(
    found: list[Scene],
    simulators: list[str],
    families: list[str],
    arguments: argparse.Namespace,
) -> int:
    jobs: list[Job] = []
    for scene in found:
        with stage(f"{scene.name}: exporting, and compiling"):
            frames = arguments.frames or FRAMES
            planned = [
                replace(job, seed=arguments.seed, waves=arguments.waves, frames=frames)
                for job in plan(scene, simulators, arguments.block)
            ]
            jobs += on_cells_of(scene.twin(), planned, families) if families else planned
    outcomes = run_shown("simulating", jobs, run_and_keep)
    if arguments.waves:
        for outcome in outcomes:
            for wave in sorted(outcome.job.folder.rglob("*.[fg][sh][tw]")):
                print(f"waves: {wave}")
    return conclude(outcomes)
