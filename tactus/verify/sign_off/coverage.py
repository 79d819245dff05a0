"""Counts how often the bench of each block meets the borders, states and port values of its twin.

    make coverage [BLOCK=input_integral] [RECORD=1]

runs the benches on Icarus, each on the entities that stand for its block. It counts how often each
side of every border, every state and every value of a port was met. A bench that leaves one of them
out fails, here as in every other run. The record shows the counts.
"""

import sys
from typing import Any

from golden.common.block import Block
from golden.input_error import InputError
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.fingerprint import fingerprint
from tactus.verify.benches.runner import Outcome, run_job, run_shown
from tactus.verify.sign_off.record import (
    cases_line,
    chosen_blocks,
    hold_recorded,
    recorded_subjects,
    source,
    write_record,
)
from tb.common.coverage import values_of

KIND = "coverage"


def named_by(twin: Block) -> str:
    """A digest of the borders, the states and the values of ports that the twin names."""
    named = [f"{border}" for border in twin.borders] + [f"{state}" for state in twin.states]
    named += [f"{port.name} {values_of(port)}" for port in twin.ports]
    return fingerprint([], *named, f"{twin.unreachable}")


def summary(outcome: Outcome) -> dict[str, Any]:
    """The record of a bench that passed, so that it met all that is not unreachable."""
    job, counts = outcome.job, outcome.facts["coverage"]
    twin = job.twin
    return {
        **source(job, outcome.facts["played"]),
        "named": named_by(twin),
        "entity": job.entity,
        "scene": job.scene.name,
        "seed": job.seed,
        "borders": sum(not border.unreachable for border in twin.borders),
        "states": sum(len(found) for found in counts.get("states", {}).values()),
        "ports": sum(len(found) for found in counts.get("ports", {}).values()),
        "unreachable": {b.name: b.unreachable for b in twin.borders if b.unreachable}
        | twin.unreachable,
    }


def main() -> int:
    arguments = arguments_of("coverage", __doc__)
    blocks = chosen_blocks(arguments.block)
    print(cases_line(arguments.block), flush=True)
    stop_if_dry_run(f"export, then run {len(blocks)} benches")
    with hold_recorded(blocks):
        return count(blocks, arguments.record)


def count(blocks: list[str], record: bool) -> int:
    """Run the benches of blocks, print what they met, and return the exit code."""
    planned = recorded_subjects(blocks)
    jobs = list(planned.values())
    outcomes = run_shown("coverage", jobs, run_job, every=False)
    failed = [outcome for outcome in outcomes if not outcome.passed]
    for name, outcome in zip(planned, outcomes, strict=True):
        if outcome.passed:
            facts = summary(outcome)
            if record:
                write_record(KIND, name, facts)
            print(
                f"{name:20} {facts['borders']:4} borders, {facts['states']:5} states, "
                f"{facts['ports']:5} values of ports, {len(facts['unreachable']):3} unreachable"
            )
    if failed:
        raise InputError("\n".join(f"{o.job.block}: {o.complaint()}" for o in failed))
    return 0


if __name__ == "__main__":
    sys.exit(run(main))
