"""i_memory against its twin: every address, also beyond the last word, in the same clock."""

import cocotb

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.memory import check_memory
from tb.common.recorded_frames import recorded_inputs
from tb.common.watch import read_only

CASES = cases("rails")


@cocotb.test()
async def every_address(dut):
    bench = Bench(dut)
    await check_memory(bench, *recorded_inputs(bench))


def properties(twin):
    broken = ((r"0: word = ", "0: word = 1 + "), (r"default: word = ", "default: word = 1 + "))
    return [read_only(twin, broken)]
