"""A fault in the exported hardware must make its bench fail, with at least one for each block."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared

from tb.common import runner
from tb.common.collected import BENCHES, CASES_OF, FAULTS
from tb.common.runner import Job, run_job

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")


def with_fault(job: Job, folder: Path, pattern: str, text: str) -> Job:
    """The job, on a copy of its files in which the first match is replaced."""
    changed = replace(job, build=folder)
    shutil.copytree(job.hdl_folder, changed.hdl_folder)
    file = changed.hdl_folder / f"{job.entity}.v"
    file.write_text(re.sub(pattern, text, file.read_text(), count=1))
    return changed


def job_of(shared: Shared, block: str, pattern: str = "", case: str = "") -> Job:
    """The first entity of a block that contains a pattern, by default in the bench's first case."""
    case = case or CASES_OF[block][0]
    # The jobs are listed in the reverse order of the entities.
    for job in reversed(shared.jobs(case, "icarus")):
        source = (job.hdl_folder / f"{job.entity}.v").read_text()
        if job.block == block and re.search(pattern, source):
            return job
    raise AssertionError(f"tb_{block}.py: FAULTS: {pattern} is in no {block} of case {case}")


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
    pattern, text = FAULTS[block][number]
    outcome = run_job(with_fault(job_of(shared, block, pattern), tmp_path, pattern, text))
    assert not outcome.passed, f"{pattern} as {text}"
    # The bench ran and found the fault, and not the compiler.
    assert re.search(r" FAIL=[1-9]", outcome.log.read_text())


# A block, one of its cases, a pattern and the text that replaces it, for what the first case of the
# block lacks. In matrices, negative results pass, halves round away from the even code, others are
# taken for halves, and a result that is too large wraps. In sums of three operands a sign is wrong,
# or a bit that passes beside an adder. A packet holds another element of theta, or none is first.
FAULTS_OF_CASES = [
    ("constant_matrix", "exact-graph", r"(rectify0_keep(?s:.*?)if \()word", r"\1!word"),
    ("constant_matrix", "exact-graph", r"(word\[\d+\] = )0;", r"\g<1>1;"),
    ("constant_matrix", "exact-graph", r"(tie_to_even0(?s:.*?)) == 0\)", r"\1 == 1)"),
    ("constant_matrix", "exact-graph", r"else if \(\(?top == 0\)?\)", "else if (1)"),
    ("constant_matrix", "operands-graph", r"turned \+ more", "turned - more"),
    ("constant_matrix", "operands-graph", r"turned - more", "turned + more"),
    ("constant_matrix", "operands-graph", r"turned - other", "turned + other"),
    ("constant_matrix", "operands-graph", r"turned \+ other", "turned - other"),
    (
        "constant_matrix",
        "operands-graph",
        r"(append0_total = \$signed\(\{add_three\d+_total, )",
        r"\1~",
    ),
    ("packet_sender", "learn-uart", r"keep_element0_place == keep_element0_wanted", "1"),
    ("packet_sender", "learn-uart", r"keep_element0_wanted <= 0", "keep_element0_wanted <= 1"),
]


@pytest.mark.parametrize("number", tiered([0], range(1, len(FAULTS_OF_CASES))))
def test_a_fault_of_a_case_turns_the_bench_red(shared: Shared, tmp_path: Path, number: int) -> None:
    block, case, pattern, text = FAULTS_OF_CASES[number]
    outcome = run_job(with_fault(job_of(shared, block, pattern, case), tmp_path, pattern, text))
    assert not outcome.passed, f"{pattern} as {text}"
    assert re.search(r" FAIL=[1-9]", outcome.log.read_text())


def test_a_bench_that_compares_nothing_fails(shared: Shared, tmp_path: Path, monkeypatch) -> None:
    """A test filter that matches no test passes in cocotb, but the runner must report a failure."""
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
