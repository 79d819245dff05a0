"""bipartite_pair against its twin: codes of tb_bipartite at both nodes, in different orders."""

import cocotb
import numpy as np

from tb.activation.tb_bipartite import EARLY_SIGN, LATE, sign
from tb.common.bench import Bench
from tb.common.case_library import BIPARTITE
from tb.common.stimulus import all_codes
from tb.common.stream import check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = {name: case for name, case in BIPARTITE.items() if name != "bipartite-logic"}


def codes(bench):
    node = bench.twin.activation
    every = np.concatenate([all_codes(node.in_fmt, node.border_codes, bench.rng), node.word_codes])
    return {"in_data_0": every, "in_data_1": bench.rng.permutation(every)}


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, codes(bench))
    bench.finish(at_least=4096)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check_gaps_and_resets(bench, codes(bench))


# Only the sign of the second node is wrong.
SECOND = tuple(part.replace(r"(\w+)negative_late", "(node1_)negative_late") for part in EARLY_SIGN)


def properties(twin):
    return [pipeline(twin, LATE), sign(twin.activation, "_0"), sign(twin.activation, "_1", SECOND)]
