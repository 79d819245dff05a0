"""A design that is placed and routed on an ECP5 computes the same as its Verilog."""

import re
from pathlib import Path

import pytest
from conftest import tiered
from shared import Shared, copied_job

from tactus.synth.timing import OPERANDS
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.sign_off.netlist import on_cells

# What a memory may return for a word that is just written, and the case in which that does harm.
COLLISION = "if (write && write_addr == read_addr) found <= 18'bx; else found <= memory"
ALWAYS = "if (write) found <= 18'bx; else found <= memory"


def engine_in(shared: Shared, case: str) -> Job:
    """The bench of the engine of a case, in Icarus."""
    (job,) = (job for job in shared.jobs(case, "icarus") if job.block == "engine")
    return job


def passes_with(job: Job, text: str) -> bool:
    """Whether the bench passes if the operand memory is read in another way."""
    (file,) = job.hdl_folder.glob(f"{OPERANDS}.v")
    source, count = re.subn(r"found <= memory", text, file.read_text())
    assert count == 1
    file.write_text(source)
    return run_job(job).passed


@pytest.mark.parametrize("case", tiered(["deep-engine"], ["chain-engine", "layers-serial"]))
def test_a_word_that_is_read_while_it_is_written_is_not_used(
    shared: Shared, tmp_path: Path, case: str
) -> None:
    assert passes_with(copied_job(engine_in(shared, case), tmp_path), COLLISION)


def test_a_word_that_is_used_would_be_found(shared: Shared, tmp_path: Path) -> None:
    job = copied_job(engine_in(shared, "deep-engine"), tmp_path)
    assert not passes_with(job, ALWAYS)


@pytest.mark.all_only
def test_a_netlist_computes_what_its_twin_does(shared: Shared) -> None:
    assert run_job(on_cells(engine_in(shared, "deep-engine"), "ecp5")).passed


@pytest.mark.all_only
def test_a_word_without_its_register_is_found(shared: Shared, tmp_path: Path) -> None:
    """The register after the port of a memory, which was moved into the memory, is needed."""
    job = on_cells(engine_in(shared, "deep-engine"), "ecp5")
    copied = copied_job(job, tmp_path)
    file = copied.hdl_folder / copied.files[0]
    text, count = re.subn(r'REGMODE_B\("OUTREG"\)', 'REGMODE_B("NOREG")', file.read_text())
    assert count
    file.write_text(text)
    assert not run_job(copied).passed
