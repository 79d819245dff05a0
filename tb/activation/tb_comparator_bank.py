"""comparator_bank against its twin.

Sweeps: every magnitude of 13 bits; of a wider input, a random one from each of 16384 equal parts of
its range, and two codes on either side of every threshold.
Drives: the inputs back to back, then in random order with gaps and resets; then, back to back, the
inputs that the block gets while the recorded frames run through the design.
Checks: address and forwarded magnitude bit for bit, and the clock of each result.
Does not prove: that the thresholds are the right ones (tests/test_gradient.py does).
"""

import cocotb
import numpy as np

from golden.numbers.fixed import Fix
from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.recorded_frames import check_recorded
from tb.common.stimulus import all_codes
from tb.common.stream import UNSIGNED, check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = PARTS

OUTPUTS = {"out_addr": UNSIGNED, "out_mag": UNSIGNED}


def magnitudes(bench):
    twin = bench.twin
    codes = all_codes(Fix(twin.mag_width + 1, 0), np.array(twin.thresholds), bench.rng)
    return codes[codes >= 0]


def expected(twin):
    return lambda mag: (twin.process(mag), mag)


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    items = {"in_mag": magnitudes(bench)}
    await check_stream(bench, items, {"in_mag": UNSIGNED}, OUTPUTS, expected(bench.twin))
    bench.finish(at_least=8192)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = {"in_mag": magnitudes(bench)}
    await check_gaps_and_resets(bench, items, {"in_mag": UNSIGNED}, OUTPUTS, expected(bench.twin))


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, {"in_mag": UNSIGNED}, OUTPUTS, expected(bench.twin))


def properties(twin):
    """Proved properties, whatever drives it."""
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && (addr == 0))"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
