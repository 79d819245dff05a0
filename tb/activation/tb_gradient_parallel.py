"""gradient_parallel against its twin.

Sweeps: every code of a 14-bit input; of a wider input, a random code from each of 16384 equal parts
of its range; two codes on either side of every threshold, of zero and of both ends, with either
sign.
Drives: the inputs back to back, then in random order with gaps and resets.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the scheme is to tanh (tests/test_schemes.py measures that).
"""

import cocotb

from tb.common import activation
from tb.common.case_library import both_precisions, rails
from tb.common.watch import pipeline

CASES = rails("gradient_parallel") | {
    "gradient_parallel-thesis": both_precisions("gradient_parallel")["gradient_parallel-thesis"]
}


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
                (r"\.in_valid\(valid_0\)", ".in_valid(valid_0 && !negative_late)"),
                (r"\.in_valid\(mag_valid\)", ".in_valid(in_valid)"),
            ),
        ),
    ]
