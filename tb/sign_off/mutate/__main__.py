"""``make mutate``: the mutation score of one block, or of every block."""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

from golden.cli import CommandError, run
from tb.common.runner import Job
from tb.sign_off.mutate.score import score
from tb.sign_off.record import read_record, record_path, write_record
from tb.sign_off.subject import chosen_blocks, subject, subjects_of

KIND = "mutation"


def line(block: str, facts: dict[str, Any]) -> str:
    """A row of the table."""
    real = len(facts["survivors"]) - facts["explained"]
    return (
        f"{block:22} {facts['mutants']:4} mutants {facts['killed']:4} killed {facts['same']:4} same"
        f" {facts['explained']:3} explained {real:3} not found  score {100 * facts['score']:6.2f} %"
    )


def main() -> int:
    parser = argparse.ArgumentParser(prog="make mutate", description=__doc__)
    parser.add_argument("--block")
    parser.add_argument("--scene", help="a scene's entities")
    parser.add_argument("--all", action="store_true", help="what is recorded is found anew, too")
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    if arguments.scene and arguments.record:
        raise CommandError("RECORD=1: got SCENE= too, expected none: records are of benches' cases")
    if arguments.scene:
        planned = subjects_of(arguments.scene, arguments.block)
    else:
        planned = [subject(block) for block in chosen_blocks(arguments.block)]
    found = True
    for job in planned:
        recorded = not arguments.scene and record_path(KIND, job.block).exists()
        before = read_record(KIND, job.block) if recorded and not arguments.all else None
        facts = show(job, before)
        found &= all(one["explained"] for one in facts["survivors"])
        if arguments.record:
            write_record(KIND, job.block, facts)
    return 0 if found else 1


def show(job: Job, before: dict[str, Any] | None) -> dict[str, Any]:
    """Find the score of an entity, and print it."""
    started = time.monotonic()
    facts = score(job, before=before, tell=lambda text: print(f"{job.block}: {text}", flush=True))
    print(f"{line(job.block, facts)}  {time.monotonic() - started:5.0f} s", flush=True)
    for one in facts["survivors"]:
        print(f"    {one['where']}  {one['what']}  {one['explained']}")
    return facts


if __name__ == "__main__":
    sys.exit(run(main))
