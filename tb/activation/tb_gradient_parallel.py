"""gradient_parallel against its twin.

Sweeps: every code of a 14-bit input; of a wider input, a random code from each of 16384 equal parts
of its range; two codes on either side of every threshold, of zero and of both ends, with either
sign.
Drives: the inputs back to back, then in random order with gaps and resets.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the scheme is to tanh (tests/test_schemes.py measures that).
"""

import cocotb

from tb.common.bench import Bench
from tb.common.small import both_precisions, rails
from tb.common.stimulus import all_codes
from tb.common.stream import SIGNED, check_gaps_and_resets, check_stream

CASES = rails("gradient_parallel") | both_precisions("gradient_parallel")
FAULTS = [
    (r"addr == 0", "addr <= 1"),
    (r"(coeff\S*) = (\d{2,})", r"\1 = \2 ^ 1"),
    (r"negative_late <= [^;]+", "negative_late <= negative"),
]

INPUTS, OUTPUTS = {"in_data": SIGNED}, {"out_data": SIGNED}


def codes(bench):
    twin = bench.twin
    return all_codes(twin.in_fmt, twin.border_codes, bench.rng)


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
