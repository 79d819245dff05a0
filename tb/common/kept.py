"""Results of benches that passed, each kept under a digest of all that enters it.

That is what is simulated, the bench and the twins (``tb/common/code.py``), the scene's files, the
seed and the number of frames, and the simulator. Failures are not kept.
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
    """What the bench found when it passed on what is there now.

    All of its tests stand for one of them, too.
    """
    for asked in [job, replace(job, test="")] if job.test else [job]:
        found = read_kept(_path(asked))
        if isinstance(found, dict):
            return Outcome(job, True, **{name: found[name] for name in FACTS})
    return None


def run_and_keep(job: Job) -> Outcome:
    """Run a bench, whatever is kept of it."""
    path = _path(job)
    outcome = run_job(job)
    if outcome.passed:
        write_kept(path, {name: getattr(outcome, name) for name in FACTS})
    return outcome


def run_kept(job: Job) -> Outcome:
    """What is kept of a bench, which is run where nothing is."""
    return kept(job) or run_and_keep(job)


def _path(job: Job) -> Path:
    files = [*(job.hdl_folder / name for name in job.files), *job.scene.files]
    facts = (job.entity, job.test, str(job.seed), str(job.frames), _version(job.simulator))
    code = bench_code(job.area, job.block)
    return job.build / "benches" / f"{fingerprint(files, *facts, code)}.json"


@cache
def _version(simulator: str) -> str:
    """Asked once: a scene may have hundreds of benches."""
    return version(simulator)
