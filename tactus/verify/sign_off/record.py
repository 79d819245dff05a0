"""Records of what was found for a block, so that datasheets and tests need not find it again.

A kind of record, such as "mutation", is one CSV file with a row for each block or recorded case of
it, sorted by name. A cell holds one field, as JSON if it is no text, or nothing where the record
has no such field.

A record says from which source it was made: the Verilog of an entity, and what the bench played on
it. A bench is identified by its trace and not by its text. The trace says what each test drove, in
which clocks it looked at which port, and how many results it compared. So a function that moves
makes no record stale, but another stimulus does. Every run of a bench compares its trace with the
records. Kept results of benches must be found before the bench runs, so their key holds the bench's
code instead (``tactus/verify/benches/results.py``).
"""

import csv
import json
import re
from collections.abc import Iterable
from contextlib import AbstractContextManager
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

from golden.input_error import InputError, MissingFileError
from tactus.core.files import reading, replace_file
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.scene import load_scene
from tactus.synth.tools import digest
from tactus.verify.benches.blocks import check_name
from tactus.verify.benches.collected import BENCHES, CASES_OF, case_scene
from tactus.verify.benches.runner import Job, Outcome, jobs, plan, prepare

# Proofs, mutants and netlists are of the Verilog.
RUNS_IN = "icarus"


def subject(block: str, case: str | None = None, simulator: str = RUNS_IN) -> Job:
    """The first entity of a block in a case; without a case, in the first one of its bench."""
    chosen_blocks(block)
    return first(_case_jobs(case or CASES_OF[block][0], simulator), block)


def chosen_blocks(block: str | None) -> list[str]:
    if block is None:
        return sorted(BENCHES)
    check_name(block)
    if not CASES_OF[block]:
        raise InputError(
            f"BLOCK={block}: CASES of its bench: got none, expected a case to take it in"
        )
    return [block]


def case_line(block: str | None) -> str:
    """The line that says in which case of its bench a block is taken, and why."""
    if block is None:
        return "each block: in the first case of its bench, as its records are"
    return f"case {CASES_OF[block][0]}: the first of the bench of {block}, as its records are"


def recorded_cases(block: str) -> dict[str, str]:
    """The cases in which a block is recorded, by name of the record; proofs and the comparison
    of both languages name their own.

    The record of the first case has the name of the block. The bench names further cases in
    ``ALSO``, where the hardware has logic that it does not have in the first.
    """
    also: tuple[str, ...] = getattr(BENCHES[block], "ALSO", ())
    return {block: CASES_OF[block][0]} | {f"{block}.{case}": case for case in also}


def hold_recorded(blocks: Iterable[str]) -> AbstractContextManager[None]:
    """Hold the folders in which blocks are exported when they are recorded."""
    return held(BUILD / case for block in blocks for case in recorded_cases(block).values())


def recorded_subjects(blocks: list[str]) -> dict[str, Job]:
    """The entities that are recorded, by the names of the records."""
    return {
        name: subject(block, case)
        for block in blocks
        for name, case in recorded_cases(block).items()
    }


def record_name(job: Job) -> str:
    """The name of the record of an entity in a case: in the first one it is that of the block."""
    case = job.scene.name
    return job.block if case == CASES_OF[job.block][0] else f"{job.block}.{case}"


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


RECORDS = Path(__file__).parent / "records"
NAME = "block"
# So many hexadecimal digits of a digest are recorded: by chance, two differ in none of them once in
# 2**64.
DIGITS = 16
# Threads of a command write one after the other, as commands do.
BETWEEN = Lock()
DIGEST = re.compile(rf"\b([0-9a-f]{{{DIGITS}}})[0-9a-f]{{44,}}\b")


def short(facts: Any) -> Any:
    """Facts as they come back from a record, with the first digits of each digest."""
    return json.loads(DIGEST.sub(r"\1", json.dumps(facts)))


def write_record(kind: str, block: str, facts: dict[str, Any]) -> None:
    with BETWEEN, held([RECORDS]):
        _write(kind, records(kind) | {block: short(facts)})


def _write(kind: str, records: dict[str, dict[str, Any]]) -> None:
    fields = sorted({field for record in records.values() for field in record})
    with (
        replace_file(_path(kind)) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
    ):
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow([NAME, *fields])
        for name, record in sorted(records.items()):
            rows.writerow([name, *(_cell(record, field) for field in fields)])


def _cell(record: dict[str, Any], field: str) -> str:
    if field not in record:
        return ""
    found = record[field]
    # A text stands as it is where it comes back as this text.
    plain = found and _value(str(found)) == found
    return str(found) if plain else json.dumps(found, sort_keys=True)


def _value(cell: str) -> Any:
    try:
        return json.loads(cell)
    except ValueError:
        return cell


def read_record(kind: str, block: str) -> dict[str, Any]:
    found = recorded(kind, block)
    if not found:
        raise MissingFileError(f"{_path(kind)}: no {kind} is recorded of {block}")
    return found


def recorded(kind: str, block: str) -> dict[str, Any]:
    """The record of a block; empty if there is none."""
    return records(kind).get(block, {})


def _path(kind: str) -> Path:
    return RECORDS / f"{kind}.csv"


def records(kind: str) -> dict[str, dict[str, Any]]:
    """All records of a kind, by the names of blocks and of recorded cases."""
    path = _path(kind)
    if not path.exists():
        return {}
    with reading(path, "a table of records"), path.open(newline="", encoding="utf-8") as file:
        return {
            row.pop(NAME): {field: _value(cell) for field, cell in row.items() if cell}
            for row in csv.DictReader(file)
        }


# This stands in a record if all tests of the bench were played.
EVERY = "all"


def verilog(job: Job) -> str:
    """A digest of the code in the files of a job, without their comments."""
    return digest(job.hdl_folder, sorted(job.files))


def source(job: Job, played: dict[str, str]) -> dict[str, Any]:
    """The fields of a record that say from which source it was made.

    job: The entity on its exported Verilog.
    played: For each test the digest of its trace, as in the facts of an ``Outcome``.
    """
    return {"verilog": verilog(job), "played": played}


# The command that makes each kind of record anew, if the record depends on a bench.
COMMANDS = {
    "mutation": "make mutate BLOCK={} RECORD=1",
    "netlist": "make sim NETLIST=1 RECORD=1 BLOCK={}",
    "unknown": "make sim NETLIST=unknown RECORD=1 BLOCK={}",
}
# The command for those of properties, and of the equality of both languages.
PROVE = "make prove BLOCK={} RECORD=1"


def another_trace(record: dict[str, Any], played: dict[str, str]) -> bool:
    """Whether a record has another trace than a whole run of the bench.

    record: It has the field ``played``. If not all tests were played, its field ``tests`` names
        those that were.
    played: For each test the digest of its trace in this run.
    """
    before: dict[str, str] = record["played"]
    played = short(played)
    if record.get("tests", EVERY) == EVERY:
        return before != played
    return not before or any(played.get(test) != found for test, found in before.items())


def stale_records(outcome: Outcome) -> list[str]:
    """A message for each record that has another trace than this run, with the command to run.

    outcome: The outcome of all tests of the bench, with the default seed and number of frames.
    """
    job = outcome.job
    found = []
    for kind, command in COMMANDS.items():
        cases = [recorded(kind, name) for name in recorded_cases(job.block)]
        of = [
            run
            for record in filter(None, cases)
            for run in record.get("runs", [record])
            if (run["scene"], run["entity"]) == (job.scene.name, job.entity)
        ]
        if any(another_trace(run, outcome.facts["played"]) for run in of):
            found.append(
                f"{job.entity} on {job.runs_on}: the record of {kind} is of another trace; "
                f"run: {command.format(job.block)}"
            )
    return found


def of_another_source(kind: str, name: str, now: str) -> list[str]:
    """What is wrong with a record of proofs that is not of the source as it is now."""
    found = recorded(kind, name)
    if found and found["source"] == short(now):
        return []
    fault = "is of another source" if found else "is missing"
    return [f"{name}: the record of {kind} {fault}; run: {PROVE.format(name.partition('.')[0])}"]
