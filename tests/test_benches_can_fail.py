"""A fault in the exported hardware turns its bench red: one or more per block."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from collected import BENCHES, CASES_OF, FAULTS
from conftest import tiered
from shared import Shared

from tb.common import runner
from tb.common.runner import Job, run_job

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")


def with_fault(job: Job, folder: Path, pattern: str, text: str) -> Job:
    """The job on a copy of its files in which the first match is replaced."""
    changed = replace(job, build=folder)
    shutil.copytree(job.hdl_folder, changed.hdl_folder)
    file = changed.hdl_folder / f"{job.entity}.v"
    source, count = re.subn(pattern, text, file.read_text(), count=1)
    assert count == 1, f"{pattern} is not in {file.name}"
    file.write_text(source)
    return changed


def job_of(shared: Shared, block: str) -> Job:
    """What the faults of a block are put into; test_benches.py runs it without one."""
    jobs = shared.jobs(CASES_OF[block][0], "icarus")
    # The first entity is the last in line. A network's last hidden node is without weights.
    return [job for job in jobs if job.block == block][-1]


@pytest.mark.parametrize(
    "fault",
    tiered(
        [(block, 0) for block in BENCHES],
        [(block, n) for block in BENCHES for n in range(1, len(FAULTS[block]))],
    ),
    ids=lambda fault: "-".join(map(str, fault)),
)
def test_a_fault_turns_the_bench_red(
    shared: Shared, tmp_path: Path, fault: tuple[str, int]
) -> None:
    block, number = fault
    outcome = run_job(with_fault(job_of(shared, block), tmp_path, *FAULTS[block][number]))
    assert not outcome.passed, FAULTS[block][number]
    # It ran and found the fault: not the compiler did.
    assert re.search(r" FAIL=[1-9]", outcome.log.read_text())


def test_a_bench_that_compares_nothing_fails(shared: Shared, tmp_path: Path, monkeypatch) -> None:
    """A test filter that matches nothing exits green in cocotb; the runner turns it red."""
    original = runner.subprocess.run

    def with_filter(command, **keywords):
        environment = keywords["env"] | {"COCOTB_TEST_FILTER": "matches_nothing"}
        return original(command, **(keywords | {"env": environment}))

    sound = job_of(shared, "abs_unit")
    copied = replace(sound, build=tmp_path)
    shutil.copytree(sound.hdl_folder, copied.hdl_folder)
    monkeypatch.setattr(runner.subprocess, "run", with_filter)
    outcome = run_job(copied)
    assert not outcome.passed
    assert outcome.compared == 0
