"""polynomial against its twin.

Sweeps: every code of a 14-bit input; of a wider input, a random code from each of 16384 equal parts
of its range; two codes on either side of every threshold, of zero and of both ends, with either
sign; the codes whose exact result lies closest to the border of the next result, with either sign.
Drives: the inputs back to back, then in random order with gaps and resets.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the scheme is to tanh (tests/test_schemes.py measures that).
"""

import cocotb
import numpy as np

from tb.common import activation
from tb.common.activation import INPUTS, OUTPUTS
from tb.common.bench import Bench
from tb.common.case_library import both_precisions, rails
from tb.common.cases import Case
from tb.common.stream import check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = {
    **rails("polynomial"),
    "polynomial-thesis": both_precisions("polynomial")["polynomial-thesis"],
    "polynomial-short": Case([(2, 1, 2)], "exact", spread=2.0, activation="polynomial"),
}

# The closest of 57344 magnitudes lie within a two-thousandth of the last bit of a border.
CLOSEST = 32


def codes(bench):
    close = bench.twin.closest_to_rounding(CLOSEST)
    return np.concatenate([activation.codes(bench), close, -close])


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, {"in_data": codes(bench)}, INPUTS, OUTPUTS, bench.twin.process)
    bench.finish(at_least=16384)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = {"in_data": codes(bench)}
    await check_gaps_and_resets(bench, items, INPUTS, OUTPUTS, bench.twin.process)


def properties(twin):
    """Proved properties, whatever drives it."""
    return [
        pipeline(
            twin,
            (
                (r"result_valid <= delay2_taps\[\(1 - 1\)\]", "result_valid <= segment_valid"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
