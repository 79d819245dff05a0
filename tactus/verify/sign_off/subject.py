"""The entity that stands for a block where it is proved, mutated or mapped to cells."""

from collections.abc import Iterable
from contextlib import AbstractContextManager
from functools import cache

from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.scene import load_scene
from tactus.verify.benches.collected import BENCHES, CASES_OF, case_scene
from tactus.verify.benches.places import check_name
from tactus.verify.benches.runner import Job, jobs, plan, prepare

# Proofs, mutants and netlists are of the Verilog.
RUNS_IN = "icarus"


def subject(block: str, simulator: str = RUNS_IN, case: str | None = None) -> Job:
    """The first entity of a block in a case; without a case, in the first one of its bench."""
    chosen_blocks(block)
    return first(_case_jobs(case or CASES_OF[block][0], simulator), block)


def chosen_blocks(block: str | None) -> list[str]:
    """The block that is named, or all blocks."""
    if block is None:
        return sorted(BENCHES)
    check_name(block)
    return [block]


def case_line(block: str | None) -> str:
    """The line that says in which case of its bench a block is taken, and why."""
    if block is None:
        return "each block: in the first case of its bench, as its records are"
    return f"case {CASES_OF[block][0]}: the first of the bench of {block}, as its records are"


def recorded_cases(block: str) -> dict[str, str]:
    """The cases in which a block is recorded, by name of the record; proofs name their own.

    The record of the first case has the name of the block. The bench names further cases in
    ``ALSO``, where the hardware has logic that it does not have in the first.
    """
    also: tuple[str, ...] = getattr(BENCHES[block], "ALSO", ())
    return {block: CASES_OF[block][0]} | {f"{block}.{case}": case for case in also}


def hold_recorded(blocks: Iterable[str]) -> AbstractContextManager[None]:
    """Hold the folders in which blocks are exported when they are recorded."""
    return held(BUILD / case for block in blocks for case in recorded_cases(block).values())


def recorded_subjects(blocks: list[str], simulator: str = RUNS_IN) -> dict[str, Job]:
    """The entities that are recorded, by the names of the records."""
    return {
        name: subject(block, simulator, case=case)
        for block in blocks
        for name, case in recorded_cases(block).items()
    }


def record_name(job: Job) -> str:
    """The name of the record of an entity in one of the cases that are recorded."""
    names = {case: name for name, case in recorded_cases(job.block).items()}
    return names[job.scene.name]


def cases_line(block: str | None) -> str:
    """The line that says in which cases a block is recorded."""
    if block is None:
        return "each block: in the cases in which it is recorded"
    _, *also = recorded_cases(block).values()
    return case_line(block) + (f"; then {' and '.join(also)}" if also else "")


def subjects_of(scene: str, block: str | None = None) -> list[Job]:
    """The first entity of each block of a scene, or of one of its blocks."""
    planned = plan(load_scene(scene), [RUNS_IN], block)
    return [first(planned, name) for name in sorted({job.block for job in planned})]


@cache
def _case_jobs(name: str, simulator: str) -> list[Job]:
    """The benches of a case. The answer is kept, because many blocks share a case."""
    scene = case_scene(name, BUILD)
    prepare(scene, simulator, BUILD)
    return jobs(scene, simulator, build=BUILD)


def first(planned: list[Job], block: str) -> Job:
    """The first entity of a block among jobs, which stand in the opposite order."""
    return next(job for job in reversed(planned) if job.block == block)
