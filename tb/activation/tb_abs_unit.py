"""abs_unit against its twin: codes and those of recorded frames, with gaps and resets."""

import cocotb

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.recorded_frames import check_recorded
from tb.common.stimulus import all_codes
from tb.common.stream import check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = cases("rails")


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, {"in_data": all_codes(bench.twin.fmt, [], bench.rng)})
    bench.finish(at_least=16384)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check_gaps_and_resets(bench, {"in_data": all_codes(bench.twin.fmt, [], bench.rng)})


@cocotb.test()
async def what_recorded_frames_bring(dut):
    await check_recorded(Bench(dut))


def properties(twin):
    broken = (
        (r"out_valid <= in_valid", "out_valid <= (in_valid || out_valid)"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
