"""lut against its twin: codes about every step of the table, back to back, with gaps and resets."""

import cocotb

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.watch import pipeline

CASES = cases("rails-lut", "lut-thesis", "lut-short")


@cocotb.test()
async def sweep(dut):
    await activation.sweep(Bench(dut))


@cocotb.test()
async def gaps_and_resets(dut):
    await activation.gaps_and_resets(Bench(dut))


def properties(twin):
    broken = ((r"word_valid <= segment_valid", "word_valid <= mag_valid"), (r"rst == 1", "0"))
    return [pipeline(twin, broken)]
