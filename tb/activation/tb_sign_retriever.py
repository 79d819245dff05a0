"""sign_retriever against its twin.

Sweeps: every magnitude of 13 bits with either sign: all 16384 inputs.
Drives: the inputs back to back, then in random order with gaps and resets; then, back to back, the
inputs that the block gets while the recorded frames run through the design.
Checks: the signed code bit for bit, and the clock in which it appears.
Does not prove: that other output formats than that of the scene work.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.recorded_frames import check_recorded
from tb.common.stream import SIGNED, UNSIGNED, check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = PARTS

INPUTS = {"in_mag": UNSIGNED, "in_negative": UNSIGNED}
OUTPUTS = {"out_data": SIGNED}


def operands(bench):
    mags = np.arange(bench.twin.fmt.high + 1)
    return {"in_mag": np.tile(mags, 2), "in_negative": np.repeat([0, 1], len(mags))}


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, operands(bench), INPUTS, OUTPUTS, bench.twin.process)
    bench.finish(at_least=16384)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = operands(bench)
    await check_gaps_and_resets(bench, items, INPUTS, OUTPUTS, bench.twin.process)


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, INPUTS, OUTPUTS, bench.twin.process)


def properties(twin):
    """Proved properties, whatever drives it."""
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && !in_negative)"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
