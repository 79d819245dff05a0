"""gradient, assembled, against its twin: codes and those of recorded frames, with gaps and resets.

How close the schemes are to tanh, here and in the other benches, is tested over all codes in
tests/.
"""

import cocotb

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.recorded_frames import check_recorded
from tb.common.watch import pipeline

CASES = cases("rails")


@cocotb.test()
async def sweep(dut):
    await activation.sweep(Bench(dut))


@cocotb.test()
async def gaps_and_resets(dut):
    await activation.gaps_and_resets(Bench(dut))


@cocotb.test()
async def what_recorded_frames_bring(dut):
    await check_recorded(Bench(dut))


def properties(twin):
    broken = (
        (r"\.in_valid\(sum_valid\)", ".in_valid(addr_valid)"),
        (r"\.in_valid\(mag_valid\)", ".in_valid(mag_valid && !negative)"),
    )
    return [pipeline(twin, broken)]
