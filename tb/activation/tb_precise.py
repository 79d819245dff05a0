"""precise, assembled, against its twin.

Sweeps: a random code from each of 16384 equal parts of the range of the 18-bit input; two codes on
either side of the border of every segment, of zero and of both ends, with either sign.
Drives: the inputs back to back, then in random order with gaps and resets.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the scheme is to tanh (tests/test_precise.py, over all codes).
"""

import cocotb

from tb.common import activation
from tb.common.case_library import PRECISE, rails
from tb.common.watch import pipeline

CASES = rails("precise") | PRECISE


@cocotb.test()
async def sweep(dut):
    await activation.sweep(dut)


@cocotb.test()
async def gaps_and_resets(dut):
    await activation.gaps_and_resets(dut)


def properties(twin):
    """Proved properties, whatever drives it."""
    return [
        pipeline(
            twin,
            (
                (r"sum_valid <= delay1_taps\[\(4 - 1\)\]", "sum_valid <= delay1_taps[2]"),
                (r"delay1_taps\[2\] <= 0;", ""),
            ),
        ),
    ]
