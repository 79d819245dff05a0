"""polynomial against its twin: codes back to back, with gaps and resets.

Among them are those whose exact result lies closest to the border of the next result.
"""

import cocotb
import numpy as np

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.watch import pipeline

CASES = cases("rails-polynomial", "polynomial-thesis", "polynomial-short")

# The closest of 57344 magnitudes lie within a two-thousandth of the last bit of a border.
CLOSEST = 32


def close(bench):
    codes = bench.twin.closest_to_rounding(CLOSEST)
    return np.concatenate([codes, -codes])


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await activation.sweep(bench, close(bench))


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await activation.gaps_and_resets(bench, close(bench))


def properties(twin):
    broken = (
        (r"result_valid <= delay2_taps\[\(1 - 1\)\]", "result_valid <= segment_valid"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
