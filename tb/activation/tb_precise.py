"""precise, assembled, against its twin: codes back to back, with gaps and resets."""

import cocotb

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.watch import pipeline

CASES = cases("rails-precise", "precise")


@cocotb.test()
async def sweep(dut):
    await activation.sweep(Bench(dut))


@cocotb.test()
async def gaps_and_resets(dut):
    await activation.gaps_and_resets(Bench(dut))


def properties(twin):
    broken = (
        (r"sum_valid <= delay1_taps\[\(4 - 1\)\]", "sum_valid <= delay1_taps[2]"),
        (r"delay1_taps\[2\] <= 0;", ""),
    )
    return [pipeline(twin, broken)]
