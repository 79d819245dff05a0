"""Benches on netlists: of each family, that they find a fault there, and what is recorded."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared, copied_job

from golden.cli import CommandError
from tb.common.collected import BENCHES, CASES_OF
from tb.common.runner import Job, run_job
from tb.sign_off.netlist import FAMILIES, chosen, on_cells

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# A memory, which is a block RAM, and what nextpnr needs a few seconds for.
SMALL, SMALL_ROUTED = "exp_memory", "ramp"


def job_of(shared: Shared, block: str) -> Job:
    """The bench of a block's first entity in its first case."""
    found = shared.jobs(CASES_OF[block][0], "icarus")
    return next(job for job in reversed(found) if job.block == block)


@pytest.mark.parametrize(
    "case",
    tiered(
        [(SMALL, "virtex-2"), (SMALL, "series-7"), (SMALL_ROUTED, "ecp5")],
        [(b, family) for b in BENCHES if b != SMALL for family in ("virtex-2", "series-7")]
        + [("engine", "ecp5"), ("hybrid", "ecp5")],
    ),
    ids="-".join,
)
def test_a_netlist_does_what_the_twin_does(shared: Shared, case: tuple[str, str]) -> None:
    block, family = case
    job = on_cells(job_of(shared, block), family)
    assert f"make sim BLOCK={block} NETLIST={family} " in run_and_read(job)


def run_and_read(job: Job) -> str:
    """The log of a bench that passes."""
    outcome = run_job(job)
    assert outcome.passed, outcome.complaint()
    return outcome.log.read_text()


@pytest.mark.parametrize(
    "fault",
    tiered(
        [("abs_unit", "virtex-2", r"(LUT\d #\(\s*\.INIT\(\d+'h)([0-9a-f]+)")],
        [
            ("abs_unit", "series-7", r"(LUT\d #\(\s*\.INIT\(\d+'h)([0-9a-f]+)"),
            (SMALL, "virtex-2", r"(\.INIT_00\(256'h[0-9a-f]*?)([0-9a-f])(?=\))"),
            (SMALL, "series-7", r"(\.INIT_00\(256'h[0-9a-f]*?)([0-9a-f])(?=\))"),
            (SMALL_ROUTED, "ecp5", r"(\.INITVAL\(16'h)([0-9a-f]+)"),
        ],
    ),
    ids=lambda fault: f"{fault[0]}-{fault[1]}",
)
def test_a_bit_of_a_cell_that_is_wrong_turns_the_bench_red(
    shared: Shared, tmp_path: Path, fault: tuple[str, str, str]
) -> None:
    block, family, pattern = fault
    job = copied_job(on_cells(job_of(shared, block), family), tmp_path)
    file = job.hdl_folder / job.files[0]

    def flip(found: re.Match[str]) -> str:
        return f"{found[1]}{int(found[2], 16) ^ 1:0{len(found[2])}x}"

    text, count = re.subn(pattern, flip, file.read_text(), count=1)
    assert count
    file.write_text(text)
    outcome = run_job(job)
    assert not outcome.passed
    assert re.search(r" FAIL=[1-9]", outcome.log.read_text())


def test_one_is_every_family() -> None:
    assert chosen("1") == list(FAMILIES)
    assert chosen("ecp5") == ["ecp5"]
    with pytest.raises(CommandError, match=r"NETLIST=2: no such family, expected one of 1, virt"):
        chosen("2")
    with pytest.raises(CommandError, match="netlists run in icarus alone"):
        chosen("1", "ghdl")
