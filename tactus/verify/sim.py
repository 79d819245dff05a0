"""``make sim``: the benches of one block, or of every block of a scene.

Without a scene the benches of the default scenes are run. A block that these do not contain is
searched elsewhere (``tactus/verify/benches/places.py``), and a line says where it was found.
Benches run on the exported VHDL and Verilog, or on the netlist that ``--netlist`` names
(``tactus/verify/sign_off/netlist.py``).
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from golden.common.block import walk
from golden.input_error import InputError
from tactus.core.cli import dry, run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.progress import stage
from tactus.verify.benches.kept_results import run_and_keep
from tactus.verify.benches.places import Place, places
from tactus.verify.benches.runner import FRAMES, Job, Outcome, plan, run_shown
from tactus.verify.benches.tools import SIMULATORS, check_simulator
from tactus.verify.sign_off.netlist import (
    NETLISTS_RUN_IN,
    chosen,
    mapped,
    on_cells_of,
    record,
)


def conclude(outcomes: list[Outcome]) -> int:
    failed = sum(not o.passed for o in outcomes)
    compared = sum(o.compared for o in outcomes)
    print(f"{len(outcomes)} benches, {failed} failed, {compared} results compared")
    return 1 if failed else 0


def main() -> int:
    arguments = arguments_of("sim", __doc__)
    if arguments.record:
        if not arguments.netlist:
            raise InputError("RECORD=1: got no NETLIST, expected 1 or unknown, which is recorded")
        return conclude(record(arguments.netlist, arguments.block))
    families = chosen(arguments.netlist, arguments.sim) if arguments.netlist else []
    simulators = [NETLISTS_RUN_IN] if families else [arguments.sim] if arguments.sim else SIMULATORS
    for simulator in simulators:
        check_simulator(simulator)
    with TemporaryDirectory() as folder:
        # A dry run must not leave the scene of a case behind.
        build = Path(folder) if dry() else BUILD
        found = places(arguments.scene, arguments.block, build)
        count = 0
        for place in found:
            if place.why:
                print(place.why, flush=True)
            design = place.scene.twin()
            asked = [p for p in walk(design) if arguments.block in (None, p.block)]
            entities = {p.entity for p in asked if not p.part_of}
            count += len(mapped(design, entities, families or simulators))
        stop_if_dry_run(f"export, then run {count} benches on {', '.join(families or simulators)}")
    with held(BUILD / place.scene.name for place in found):
        return simulate(found, list(simulators), families, arguments)


def simulate(
    found: list[Place],
    simulators: list[str],
    families: list[str],
    arguments: argparse.Namespace,
) -> int:
    jobs: list[Job] = []
    for place in found:
        with stage(f"{place.scene.name}: exporting, and compiling"):
            planned = [
                replace(
                    job,
                    seed=arguments.seed,
                    waves=arguments.waves,
                    frames=arguments.frames or FRAMES,
                )
                for job in plan(place.scene, simulators, arguments.block)
            ]
            jobs += on_cells_of(place.scene.twin(), planned, families) if families else planned
    outcomes = run_shown("simulating", jobs, run_and_keep)
    if arguments.waves:
        for outcome in outcomes:
            for wave in sorted(outcome.job.folder.rglob("*.[fg][sh][tw]")):
                print(f"waves: {wave}")
    return conclude(outcomes)


if __name__ == "__main__":
    sys.exit(run(main))
