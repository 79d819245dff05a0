"""The results of benches that passed, each kept under a digest of all that it depends on.

The digest covers the simulated files, the bench and the twins (``tb/common/code.py``), the files of
the scene, the seed, the number of frames, and the simulator. Failures are not kept.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from golden.files import read_kept, write_kept
from golden.fingerprint import fingerprint
from tb.common.code import bench_code
from tb.common.runner import Job, Outcome, run_job
from tb.common.tools import version

FACTS = ("compared", "seconds", "facts")


def kept(job: Job) -> Outcome | None:
    """The kept result of a bench, if nothing that it depends on has changed.

    A result of all tests of a bench also counts as the result of one of them.
    """
    for asked in [job, replace(job, test="")] if job.test else [job]:
        found = read_kept(_path(asked))
        if isinstance(found, dict):
            return Outcome(job, True, **{name: found[name] for name in FACTS})
    return None


def run_and_keep(job: Job) -> Outcome:
    """Run a bench, even if a result is kept, and keep the new result."""
    path = _path(job)
    outcome = run_job(job)
    if outcome.passed:
        write_kept(path, {name: getattr(outcome, name) for name in FACTS})
    return outcome


def run_kept(job: Job) -> Outcome:
    """The kept result of a bench, which runs if there is none."""
    return kept(job) or run_and_keep(job)


def _path(job: Job) -> Path:
    files = [*(job.hdl_folder / name for name in job.files), *job.scene.files]
    facts = (job.entity, job.test, str(job.seed), str(job.frames), _version(job.simulator))
    code = bench_code(job.area, job.block)
    return job.build / "benches" / f"{fingerprint(files, *facts, code)}.json"


@cache
def _version(simulator: str) -> str:
    """The version of a simulator.

    It is asked only once, as a scene may have hundreds of benches.
    """
    return version(simulator)
