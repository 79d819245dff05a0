"""Checks that the records of a block belong to what its bench does now."""

from typing import Any

from tactus.verify.benches.runner import Outcome
from tactus.verify.sign_off.record import read_record, recorded, short
from tactus.verify.sign_off.source import EVERY
from tactus.verify.sign_off.subject import recorded_cases

# The command that makes each kind of record anew, if the record depends on a bench.
COMMANDS = {
    "coverage": "make coverage BLOCK={} RECORD=1",
    "mutation": "make mutate BLOCK={} RECORD=1",
    "netlist": "make sim NETLIST=1 RECORD=1 BLOCK={}",
    "unknown": "make sim NETLIST=unknown RECORD=1 BLOCK={}",
}


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
