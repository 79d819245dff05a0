"""Records of what was found for a block, so that datasheets and tests need not find it again.

A kind of record, such as "mutation", is one CSV file with a row for each block or recorded case of
it, sorted by name. A cell holds one field, as JSON if it is no text, or nothing where the record
has no such field.

A record says from which source it was made: the Verilog of an entity, and what the bench played on
it. A bench is identified by its trace and not by its text. The trace says what each test drove, in
which clocks it looked at which port, and how many results it compared. So a function that moves
makes no record stale, but another stimulus does. Every run of a bench compares its trace with the
records. Kept results of benches must be found before the bench runs, so their key holds the bench's
code instead (``tactus/verify/benches/kept_results.py``).
"""

import csv
import json
import re
from pathlib import Path
from threading import Lock
from typing import Any

from golden.input_error import MissingFileError
from tactus.core.files import reading, replace_file
from tactus.core.hold import held
from tactus.synth.tools import digest
from tactus.verify.benches.runner import Job, Outcome
from tactus.verify.sign_off.subject import recorded_cases

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
    """Record what was found for a block."""
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
    """The record of a block."""
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
    "coverage": "make coverage BLOCK={} RECORD=1",
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


def of_this_verilog(kind: str, name: str, now: str) -> str:
    """Empty if a record is of the Verilog as it is now; otherwise what is wrong, and the command.

    kind, name: The record; see ``recorded_cases``.
    now: The digest that ``verilog`` gives for the entity that stands for the block in that case.
    """
    found, block = read_record(kind, name)["verilog"], name.partition(".")[0]
    return "" if found == short(now) else f"of another Verilog; run: {COMMANDS[kind].format(block)}"


def of_another_source(kind: str, block: str, now: str) -> list[str]:
    """What is wrong with a record that is not of the source as it is now; nothing if it is."""
    found = recorded(kind, block)
    if not found:
        return ["is missing"]
    return [] if found["source"] == short(now) else ["is of another source"]
