"""bipartite against its twin: codes over the whole range, back to back, with gaps and resets.

For each bit of every word of both tables there is a code of either sign whose result it changes.
"""

import cocotb

from tb.common import activation
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.watch import pipeline

CASES = cases("bipartite")


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await activation.sweep(bench, bench.twin.word_codes, at_least=4096)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await activation.gaps_and_resets(bench, bench.twin.word_codes)


# In one copy the valid flag skips its last register, in the other a register has no reset.
LATE = (
    (r"out_valid <= (\w+)\[\(3 - 1\)\]", r"out_valid <= \1[1]"),
    (r"(delay\d+_taps\[2\]) <= 0;", ""),
)


def properties(twin):
    return [pipeline(twin, LATE)]
