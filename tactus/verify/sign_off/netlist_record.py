"""Records what benches find on netlists, with ``make sim NETLIST=1 RECORD=1`` or ``=unknown``.

Recorded are the first entity of every block in the cases of its bench that are recorded and, on
cells, the entities of the scenes whose network is an engine. The result of a bench that has passed
is kept until its netlist or the bench changes. An engine, and the instrument around it on a board,
only play recorded frames, in its own image and, where the bench has some, in others. The rest of
their benches would take hours; their parts run through the whole of theirs.
"""

import os
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

from golden.common.block import walk
from golden.input_error import InputError
from tactus.core.cli import stop_if_dry_run
from tactus.core.progress import Progress
from tactus.scene import load_scene
from tactus.verify.benches.kept_results import run_kept
from tactus.verify.benches.runner import Job, Outcome, jobs, prepare, run_jobs
from tactus.verify.sign_off.netlist import ALL, FAMILIES, NETLISTS_RUN_IN, ROUTED, chosen, on_cells
from tactus.verify.sign_off.record import write_record
from tactus.verify.sign_off.source import EVERY, source, verilog
from tactus.verify.sign_off.subject import (
    chosen_blocks,
    hold_recorded,
    record_name,
    recorded_cases,
    recorded_subjects,
    subject,
)
from tactus.verify.sign_off.unknown import UNKNOWN, Netlist
from tactus.verify.sign_off.unknown_proof import clocks_to_prove

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
Tell = Callable[[Outcome, Callable[[str], None]], None]


def played(job: Job) -> Job:
    """The job with the tests of its bench that are played on a netlist."""
    return replace(job, test=PLAYED.get(job.block, ""))


@dataclass(frozen=True)
class Entity:
    """An entity that is mapped and played: a job on Verilog, which is a part of ``top``."""

    job: Job
    top: str

    def families(self) -> list[str]:
        """The families to whose cells it is mapped; only a whole design is placed."""
        whole = self.job.entity == self.job.scene.twin().entity
        return [family for family in FAMILIES if whole or family != ROUTED]


def entities(blocks: Collection[str]) -> Iterator[Entity]:
    """The entities of some blocks that are recorded; one that several scenes share comes once."""
    seen = set()
    for block in blocks:
        for case in recorded_cases(block).values():
            job = played(subject(block, NETLISTS_RUN_IN, case=case))
            seen.add(verilog(job))
            yield Entity(job, job.entity)
    for name in SCENES:
        scene = load_scene(name)
        if not any(part.block in blocks for part in walk(scene.twin())):
            continue
        prepare(scene, NETLISTS_RUN_IN)
        for job in jobs(scene, NETLISTS_RUN_IN):
            if job.block in blocks and verilog(job) not in seen:
                seen.add(verilog(job))
                yield Entity(played(job), scene.twin().entity)


def record_netlists(blocks: Collection[str], tell: Tell) -> list[Outcome]:
    """Run the benches of some blocks on the netlists of all families, and record the results.

    A block of which a bench fails keeps the record that it has.
    """
    runs: dict[str, list[dict[str, Any]]] = {}
    outcomes = []
    pairs = [(entity, family) for entity in entities(blocks) for family in entity.families()]
    with (
        ThreadPoolExecutor(os.cpu_count()) as pool,
        Progress("simulating", len(pairs), "netlists") as progress,
    ):
        for (entity, family), outcome in zip(pairs, pool.map(_run, pairs), strict=True):
            tell(outcome, progress.say)
            progress.step(entity.job.entity)
            outcomes.append(outcome)
            runs.setdefault(entity.job.block, []).append(
                {
                    "scene": entity.job.scene.name,
                    "entity": entity.job.entity,
                    "family": family,
                    **source(entity.job, outcome.facts["played"]),
                    "tests": entity.job.test or EVERY,
                    "compared": outcome.compared,
                    "frames": outcome.facts.get("frames", 0),
                    "passed": outcome.passed,
                }
            )
    for block, lines in runs.items():
        if all(line["passed"] for line in lines):
            write_record(KIND, block, {"runs": lines})
    return outcomes


def _run(pair: tuple[Entity, str]) -> Outcome:
    entity, family = pair
    return run_kept(on_cells(entity.job, family, entity.top))


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


def record(given: str, block: str | None, tell: Tell) -> list[Outcome]:
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
        return record_netlists(blocks, tell) if every else record_unknowns(blocks, tell)


def record_unknowns(blocks: list[str], tell: Tell) -> list[Outcome]:
    """Run the benches of some blocks with unknown registers, and record what is compared."""
    subjects = [played(job) for job in recorded_subjects(blocks, NETLISTS_RUN_IN).values()]
    with Progress("simulating unknown registers of", len(subjects), "entities") as progress:

        def listen(outcome: Outcome) -> None:
            tell(outcome, progress.say)
            progress.step(outcome.job.block)

        return run_jobs(subjects, listen, work=record_unknown)
