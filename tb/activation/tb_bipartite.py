"""bipartite against its twin.

Sweeps: a random code from each of 16384 equal parts of the input's range, or every code of a narrow
input; for each bit of every word of both tables, a code of either sign whose result it changes; two
codes on either side of 2, 4, 8, zero and both ends.
Drives: the inputs back to back, then in random order with gaps and resets.
Checks: the activation bit for bit, and the clock in which it appears.
Does not prove: how close the tables are to tanh (tests/test_bipartite.py, over all codes).
"""

import cocotb
import numpy as np

from tb.common import activation
from tb.common.activation import INPUTS, OUTPUTS
from tb.common.bench import Bench
from tb.common.case_library import BIPARTITE
from tb.common.stream import check_gaps_and_resets, check_stream

CASES = BIPARTITE


def codes(bench):
    return np.concatenate([activation.codes(bench), bench.twin.word_codes])


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, {"in_data": codes(bench)}, INPUTS, OUTPUTS, bench.twin.process)
    bench.finish(at_least=4096)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = {"in_data": codes(bench)}
    await check_gaps_and_resets(bench, items, INPUTS, OUTPUTS, bench.twin.process)
