"""lut against its twin.

Sweeps: every code of a 14-bit input; of a wider input, a random code from each of 16384 equal parts
of its range; two codes on either side of every step of the table, of its end, of zero and of both
ends, with either sign.
Drives: the inputs back to back, then in random order with gaps and resets.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the scheme is to tanh (tests/test_schemes.py measures that).
"""

import cocotb

from tb.common import activation
from tb.common.case_library import both_precisions, rails
from tb.common.cases import Case
from tb.common.watch import pipeline

CASES = {
    **rails("lut"),
    "lut-thesis": both_precisions("lut")["lut-thesis"],
    "lut-short": Case([(2, 1, 2)], "thesis", spread=2.0, activation="lut"),
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
                (r"word_valid <= segment_valid", "word_valid <= mag_valid"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
