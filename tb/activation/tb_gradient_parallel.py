"""gradient_parallel against its twin: codes back to back, with gaps and resets."""

import cocotb

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.watch import pipeline

CASES = cases("rails-gradient_parallel", "gradient_parallel-thesis")


@cocotb.test()
async def sweep(dut):
    await activation.sweep(Bench(dut))


@cocotb.test()
async def gaps_and_resets(dut):
    await activation.gaps_and_resets(Bench(dut))


def properties(twin):
    broken = (
        (r"\.in_valid\(valid_0\)", ".in_valid(valid_0 && !negative_late)"),
        (r"\.in_valid\(mag_valid\)", ".in_valid(in_valid)"),
    )
    return [pipeline(twin, broken)]
