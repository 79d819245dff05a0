"""``make mutate``: find the mutation score of one block, or of every block."""

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from golden.input_error import InputError
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import processor_line, processor_minutes
from tactus.scene import load_scene
from tactus.verify.benches.blocks import check_block
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.mutate.score import SEED, score
from tactus.verify.sign_off.record import (
    cases_line,
    chosen_blocks,
    hold_recorded,
    recorded_subjects,
    subjects_of,
    write_record,
)

KIND = "mutation"
BESIDE = 2


def line(block: str, facts: dict[str, Any]) -> str:
    """A row of the table."""
    real = len(facts["survivors"]) - facts["explained"]
    return (
        f"{block:22} {facts['mutants']:4} mutants {facts['killed']:4} detected "
        f"{facts['same']:4} equivalent {facts['explained']:3} explained {real:3} not explained  "
        f"score {100 * facts['score']:6.2f} %"
    )


def main() -> int:
    arguments = arguments_of("mutate", __doc__)
    if arguments.record and arguments.seed != SEED:
        raise InputError(
            f"RECORD=1: got SEED={arguments.seed}, expected none: records are of seed {SEED}, so "
            "that another run can compare itself with them"
        )
    if arguments.scene and arguments.record:
        raise InputError(
            "RECORD=1: got SCENE= too, expected none: only the cases of benches are recorded"
        )
    if arguments.scene:
        scene = load_scene(arguments.scene)
        check_block(scene, arguments.block)
        stop_if_dry_run(
            f"export scene {arguments.scene} and mutate {arguments.block or 'its blocks'}"
        )
        with held([BUILD / scene.name]):
            jobs = subjects_of(arguments.scene, arguments.block)
            return mutate({job.block: job for job in jobs}, arguments)
    blocks = chosen_blocks(arguments.block)
    print(f"seed {arguments.seed}")
    print(cases_line(arguments.block), flush=True)
    stop_if_dry_run(f"export and mutate {len(blocks)} blocks")
    with hold_recorded(blocks):
        return mutate(recorded_subjects(blocks), arguments)


def mutate(planned: dict[str, Job], arguments: argparse.Namespace) -> int:
    """Find the score of each entity, print it, and return the exit code."""
    found = True

    def work(name: str, job: Job) -> dict[str, Any]:
        def tell(text: str) -> None:
            print(f"{name}: {text}", flush=True)

        facts = score(job, seed=arguments.seed, tell=tell)
        if arguments.record:
            write_record(KIND, name, facts)
        return facts

    # Two blocks run side by side, because parts of the work, such as the first run of the bench,
    # use a single processor.
    with ThreadPoolExecutor(BESIDE) as pool:
        for name, facts in zip(
            planned, pool.map(work, *zip(*planned.items(), strict=True)), strict=True
        ):
            print(line(name, facts), flush=True)
            for one in facts["survivors"]:
                print(f"    {one['where']}  {one['what']}  {one['explained']}", flush=True)
            found &= all(one["explained"] for one in facts["survivors"])
    print(processor_line(processor_minutes()))
    return 0 if found else 1


if __name__ == "__main__":
    sys.exit(run(main))
