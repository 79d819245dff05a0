"""Whether the records of a block are of what its bench does now."""

from __future__ import annotations

from typing import Any

from tb.common.runner import Outcome
from tb.sign_off.record import read_record
from tb.sign_off.source import EVERY

# What makes each kind of record that is of a bench, anew.
COMMANDS = {
    "coverage": "make coverage BLOCK={} RECORD=1",
    "mutation": "make mutate BLOCK={} RECORD=1",
    "netlist": "make sim NETLIST=1 RECORD=1 BLOCK={}",
    "unknown": "make sim NETLIST=unknown RECORD=1 BLOCK={}",
}


def another_trace(record: dict[str, Any], played: dict[str, str]) -> bool:
    """Whether a record is of another trace than a whole run of the bench.

    Parameters
    ----------
    record : dict
        With the field ``played``; its ``tests`` name those that were played, if not all.
    played : dict of str
        By test: the digest of its trace in this run.
    """
    recorded: dict[str, str] = record["played"]
    if record.get("tests", EVERY) == EVERY:
        return recorded != played
    return not recorded or any(played.get(test) != found for test, found in recorded.items())


def stale_records(outcome: Outcome) -> list[str]:
    """What a run of a bench shows to be recorded of another trace: the command for each.

    Parameters
    ----------
    outcome : Outcome
        Of all tests of the bench, with the default seed and number of frames.
    """
    job = outcome.job
    found = []
    for kind, command in COMMANDS.items():
        record = read_record(kind, job.block)
        of = [
            run
            for run in record.get("runs", [record])
            if (run["scene"], run["entity"]) == (job.scene.name, job.entity)
        ]
        if any(another_trace(run, outcome.facts["played"]) for run in of):
            found.append(
                f"{job.entity} on {job.runs_on}: the record of {kind} is of another trace; "
                f"run: {command.format(job.block)}"
            )
    return found


def of_this_verilog(kind: str, block: str, now: str) -> str:
    """What is wrong with the source of a record, with the command that makes it anew; or nothing.

    Parameters
    ----------
    now : str
        The digest that ``verilog`` gives of the entity that stands for the block.
    """
    recorded = read_record(kind, block)["verilog"]
    return "" if recorded == now else f"of another Verilog; run: {COMMANDS[kind].format(block)}"
