"""abs_unit against its twin.

Sweeps: every code of a 14-bit input; of a wider input, a random code from each of 16384 equal parts
of its range, and the neighbourhood of zero and of both ends.
Drives: the inputs back to back, then in random order with gaps and resets; then, back to back, the
inputs that the block gets while the recorded frames run through the design.
Checks: magnitude and sign bit for bit, and the clock in which each result appears.
Does not prove: the wide input exhaustively (the twin is checked on all of it in tests/).
"""

import cocotb

from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.recorded_frames import check_recorded
from tb.common.stimulus import all_codes
from tb.common.stream import SIGNED, UNSIGNED, check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = PARTS

OUTPUTS = {"out_mag": UNSIGNED, "out_negative": UNSIGNED}


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    codes = all_codes(bench.twin.fmt, [], bench.rng)
    await check_stream(bench, {"in_data": codes}, {"in_data": SIGNED}, OUTPUTS, bench.twin.process)
    bench.finish(at_least=16384)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = {"in_data": all_codes(bench.twin.fmt, [], bench.rng)}
    await check_gaps_and_resets(bench, items, {"in_data": SIGNED}, OUTPUTS, bench.twin.process)


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, {"in_data": SIGNED}, OUTPUTS, bench.twin.process)


def properties(twin):
    """Proved properties, whatever drives it."""
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid || out_valid)"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
