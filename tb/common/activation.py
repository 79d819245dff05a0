"""What the benches of all activations that take a code a clock do.

The tests themselves stand in each bench, because the seed of a test follows from its module.
"""

from tb.common.bench import Bench
from tb.common.stimulus import all_codes
from tb.common.stream import SIGNED, check_gaps_and_resets, check_stream

INPUTS, OUTPUTS = {"in_data": SIGNED}, {"out_data": SIGNED}


def codes(bench):
    twin = bench.twin
    return all_codes(twin.in_fmt, twin.border_codes, bench.rng)


async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, {"in_data": codes(bench)}, INPUTS, OUTPUTS, bench.twin.process)
    bench.finish(at_least=16384)


async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = {"in_data": codes(bench)}
    await check_gaps_and_resets(bench, items, INPUTS, OUTPUTS, bench.twin.process)
