"""comparator_bank against its twin: magnitudes and those of recorded frames, with gaps and resets.

That the thresholds are the right ones is tested in tests/test_schemes.py.
"""

import cocotb
import numpy as np

from golden.numbers.fixed import Fix
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.recorded_frames import check_recorded
from tb.common.stimulus import all_codes
from tb.common.stream import check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = cases("rails")


def magnitudes(bench):
    twin = bench.twin
    codes = all_codes(Fix(twin.mag_width + 1, 0), np.array(twin.thresholds), bench.rng)
    return codes[codes >= 0]


def expected(twin):
    return lambda mag: (twin.process(mag), mag)


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_stream(bench, {"in_mag": magnitudes(bench)}, expected(bench.twin))
    bench.finish(at_least=8192)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check_gaps_and_resets(bench, {"in_mag": magnitudes(bench)}, expected(bench.twin))


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, expected(bench.twin))


def properties(twin):
    broken = (
        (r"out_valid <= in_valid", "out_valid <= (in_valid && (addr == 0))"),
        (r"rst == 1", "0"),
    )
    return [pipeline(twin, broken)]
