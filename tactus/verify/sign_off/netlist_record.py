"""Records what benches find on netlists, with ``make sim NETLIST=1 RECORD=1`` or ``=unknown``.

Recorded are the first entity of every block in the cases of its bench that are recorded and, on
cells, the entities of the scenes whose network is an engine. The result of a bench that has passed
is kept until its netlist or the bench changes. An engine, and the instrument around it on a board,
only play recorded frames, in its own image and, where the bench has some, in others. The rest of
their benches would take hours; their parts run through the whole of theirs.
"""

import os
from collections.abc import Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

from golden.common.block import walk
from golden.input_error import InputError
from tactus.core.cli import stop_if_dry_run
from tactus.core.progress import Progress
from tactus.scene import load_scene
from tactus.verify.benches.kept_results import run_kept
from tactus.verify.benches.runner import Job, Outcome, jobs, prepare, run_shown, tell
from tactus.verify.sign_off.netlist import ALL, FAMILIES, NETLISTS_RUN_IN, ROUTED, chosen, on_cells
from tactus.verify.sign_off.record import EVERY, source, verilog, write_record
from tactus.verify.sign_off.subject import (
    chosen_blocks,
    hold_recorded,
    record_name,
    recorded_cases,
    recorded_subjects,
    subject,
)
from tactus.verify.sign_off.unknown import UNKNOWN, Netlist, clocks_to_prove

KIND = "netlist"
# Scenes whose network is an engine. Those of the rig swing are left out, because their 5000 frames
# take half an hour.
SCENES = (
    "digit",
    "digit-load",
    "digit-multiple",
    "digit-reload",
    "digit-instrument",
    "comparison/digit-single-engine",
)
# A regular expression for the tests that are played on a block; on all other blocks, all are.
PLAYED = {
    "engine": "(recorded)",
    "uart_instrument": "(recorded)",
}


def played(job: Job) -> Job:
    """The job with the tests of its bench that are played on a netlist."""
    return replace(job, test=PLAYED.get(job.block, ""))


def families_of(job: Job) -> list[str]:
    """The families to whose cells an entity is mapped; only a whole design is placed."""
    whole = job.entity == job.scene.twin().entity
    return [family for family in FAMILIES if whole or family != ROUTED]


def entities(blocks: Collection[str]) -> Iterator[tuple[Job, str]]:
    """The entities of some blocks that are recorded, each with the entity that is mapped with it.

    One that several scenes share comes once.
    """
    seen = set()
    for block in blocks:
        for case in recorded_cases(block).values():
            job = played(subject(block, NETLISTS_RUN_IN, case=case))
            seen.add(verilog(job))
            yield job, job.entity
    for name in SCENES:
        scene = load_scene(name)
        if not any(part.block in blocks for part in walk(scene.twin())):
            continue
        prepare(scene, NETLISTS_RUN_IN)
        for job in jobs(scene, NETLISTS_RUN_IN):
            if job.block in blocks and verilog(job) not in seen:
                seen.add(verilog(job))
                yield played(job), scene.twin().entity


def record_netlists(blocks: Collection[str]) -> list[Outcome]:
    """Run the benches of some blocks on the netlists of all families, and record the results.

    A block of which a bench fails keeps the record that it has.
    """
    runs: dict[str, list[dict[str, Any]]] = {}
    outcomes = []
    asked = [(*one, family) for one in entities(blocks) for family in families_of(one[0])]
    with (
        ThreadPoolExecutor(os.cpu_count()) as pool,
        Progress("simulating", len(asked), "netlists") as progress,
    ):
        for (job, _, family), outcome in zip(asked, pool.map(_run, asked), strict=True):
            tell(outcome, progress.say)
            progress.step(job.entity)
            outcomes.append(outcome)
            runs.setdefault(job.block, []).append(
                {
                    "scene": job.scene.name,
                    "entity": job.entity,
                    "family": family,
                    **source(job, outcome.facts["played"]),
                    "tests": job.test or EVERY,
                    "compared": outcome.compared,
                    "frames": outcome.facts.get("frames", 0),
                    "passed": outcome.passed,
                }
            )
    for block, lines in runs.items():
        if all(line["passed"] for line in lines):
            write_record(KIND, block, {"runs": lines})
    return outcomes


def _run(asked: tuple[Job, str, str]) -> Outcome:
    job, top, family = asked
    return run_kept(on_cells(job, family, top))


def record_unknown(job: Job) -> Outcome:
    """Run and record a block with unknown registers, and with one register whose reset is left out.

    That register is the control: the first one without whose reset the bench fails. It shows that
    the bench detects an unknown register.
    """
    netlist = Netlist(job)
    outcome = run_kept(netlist.bench(job))
    registers = netlist.registers()
    reset = [register for register in registers if register.reset]
    control = next((r for r in reset if not run_kept(netlist.bench(job, r)).passed), None)
    facts = {
        "proved over clocks": clocks_to_prove(netlist) if reset else None,
        **source(job, outcome.facts["played"]),
        "scene": job.scene.name,
        "entity": job.entity,
        "tests": job.test or EVERY,
        "compared": outcome.compared,
        "passed": outcome.passed,
        "reset": len(reset),
        "not reset": len(registers) - len(reset),
        "control": control.name if control else "",
        "control proved over clocks": clocks_to_prove(netlist, control) if control else None,
    }
    write_record(UNKNOWN, record_name(job), facts)
    return outcome


def record(given: str, block: str | None) -> list[Outcome]:
    """Record the netlists that ``NETLIST=`` names, for one block or for all."""
    blocks = chosen_blocks(block)
    every = chosen(given) == list(FAMILIES)
    if not every and given != UNKNOWN:
        raise InputError(
            f"NETLIST={given}: got RECORD=1 too, which records every family, expected "
            f"NETLIST={ALL} or NETLIST={UNKNOWN}"
        )
    stop_if_dry_run(f"run the benches of {len(blocks)} blocks with NETLIST={given} and record them")
    with hold_recorded(blocks):
        return record_netlists(blocks) if every else record_unknowns(blocks)


def record_unknowns(blocks: list[str]) -> list[Outcome]:
    """Run the benches of some blocks with unknown registers, and record what is compared."""
    subjects = [played(job) for job in recorded_subjects(blocks, NETLISTS_RUN_IN).values()]
    return run_shown("unknown registers", subjects, record_unknown)
