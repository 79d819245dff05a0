"""gradient, assembled, against its twin.

Sweeps: every code of a 14-bit input; of a wider input, a random code from each of 16384 equal parts
of its range; two codes on either side of every threshold, of zero and of both ends, with either
sign.
Drives: the inputs back to back, then in random order with gaps and resets; then, back to back, the
inputs that the block gets while the recorded frames run through the design.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the scheme is to tanh (tests/test_gradient.py measures that).
"""

import cocotb

from tb.common import activation
from tb.common.activation import INPUTS, OUTPUTS
from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.recorded_frames import check_recorded
from tb.common.watch import pipeline

CASES = PARTS


@cocotb.test()
async def sweep(dut):
    await activation.sweep(dut)


@cocotb.test()
async def gaps_and_resets(dut):
    await activation.gaps_and_resets(dut)


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
                (r"\.in_valid\(sum_valid\)", ".in_valid(addr_valid)"),
                (r"\.in_valid\(mag_valid\)", ".in_valid(mag_valid && !negative)"),
            ),
        ),
    ]
