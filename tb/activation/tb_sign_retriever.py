"""sign_retriever against its twin: all inputs and those of recorded frames."""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.recorded_frames import check_recorded
from tb.common.stream import check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = cases("rails")


def operands(bench):
    mags = np.arange(bench.twin.fmt.high + 1)
    return {"in_mag": np.tile(mags, 2), "in_negative": np.repeat([0, 1], len(mags))}


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, operands(bench))
    bench.finish(at_least=16384)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check_gaps_and_resets(bench, operands(bench))


@cocotb.test()
async def what_recorded_frames_bring(dut):
    await check_recorded(Bench(dut))


def properties(twin):
    broken = (
        (r"out_valid <= in_valid", "out_valid <= (in_valid && !in_negative)"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
