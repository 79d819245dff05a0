"""power_fold against its twin.

Sweeps: every P with the extremes of t, with t around 1 and around the value whose power saturates,
and with one random t of each of 256 equal parts of the range.
Drives: the pairs that the recorded frames bring, as close as the block takes them; then those of
the sweep likewise, in random order with gaps and resets, and closer than the block takes them.
Checks: the power bit for bit, and the clock in which it appears, which is the same for every P;
that a pair which is followed too soon has no result.
Does not prove: that every t is right (tests/test_visualisation.py bounds the profile over
everything that the divider gives).
"""

import cocotb
import numpy as np

from golden.visualisation.power_fold import border_data
from tb.common.bench import Bench
from tb.common.case_library import DRAWN
from tb.common.recorded_frames import check_recorded
from tb.common.stream import UNSIGNED, check_early, check_gaps_and_resets, check_in_parts

CASES = DRAWN

INPUTS = {"in_data": UNSIGNED, "in_power": UNSIGNED}
OUTPUTS = {"out_data": UNSIGNED}
PARTS = 256


def pairs(bench):
    twin = bench.twin
    powers = np.arange(1, twin.max_power + 1)
    one, most = 1 << twin.in_frac, (1 << twin.in_width) - 1
    near = (
        np.concatenate([[0, one, most], border_data(twin)])[:, np.newaxis] + np.arange(-2, 3)
    ).ravel()
    step = (most + 1) // PARTS
    spread = np.arange(0, most + 1, step) + bench.rng.integers(0, step, PARTS)
    t = np.concatenate([near[(near >= 0) & (near <= most)], spread])
    return {"in_data": np.tile(t, len(powers)), "in_power": np.repeat(powers, len(t))}


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, INPUTS, OUTPUTS, bench.twin.process, interval=bench.twin.interval)


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    await check_in_parts(bench, pairs(bench), INPUTS, OUTPUTS)
    bench.finish(at_least=PARTS * bench.twin.max_power)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    twin = bench.twin
    await check_gaps_and_resets(
        bench, pairs(bench), INPUTS, OUTPUTS, twin.process, interval=twin.interval
    )


@cocotb.test()
async def early(dut):
    bench = Bench(dut)
    twin = bench.twin
    await check_early(bench, pairs(bench), INPUTS, OUTPUTS, twin.process, twin.interval)
