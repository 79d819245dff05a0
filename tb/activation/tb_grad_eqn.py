"""grad_eqn against its twin.

Sweeps: for every segment of the neuron, its two ends and 1000 random magnitudes within it; and
magnitudes on either side of 100 places at which the result changes.
Drives: the inputs back to back, then in random order with gaps and resets; then, back to back, the
inputs that the block gets while the recorded frames run through the design.
Checks: the result bit for bit, and the clock in which it appears.
Does not prove: combinations of a magnitude and constants that occur in no segment of the scene.
"""

import cocotb
import numpy as np

from golden.activation.gradient import Gradient
from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.recorded_frames import check_recorded
from tb.common.stream import UNSIGNED, check_gaps_and_resets, check_stream
from tb.common.watch import pipeline

CASES = PARTS

INPUTS = {"in_mag": UNSIGNED, "in_coeff": UNSIGNED, "in_intercept": UNSIGNED}
OUTPUTS = {"out_data": UNSIGNED}
STEPS = 100


def operands(bench):
    """Magnitudes of each segment, with the constants of the segment."""
    table = bench.around(Gradient)[0].table
    ends = [-1, *table.thresholds, (1 << bench.twin.mag_width) - 1]
    columns = {name: [] for name in INPUTS}
    for n, (coeff, intercept) in enumerate(zip(table.coeffs, table.intercepts, strict=True)):
        low, high = ends[n] + 1, ends[n + 1]
        mags = np.concatenate([[low, high], bench.rng.integers(low, high + 1, 1000)])
        every = np.arange(low, high + 1)
        steps = every[:-1][np.diff(bench.twin.process(every, coeff, intercept)) != 0]
        steps = bench.rng.permutation(steps)[:STEPS]
        mags = np.concatenate([mags, steps, steps + 1])
        columns["in_mag"].append(mags)
        columns["in_coeff"].append(np.full(len(mags), coeff))
        columns["in_intercept"].append(np.full(len(mags), intercept))
    return {name: np.concatenate(values) for name, values in columns.items()}


@cocotb.test()
async def segments(dut):
    bench = Bench(dut)
    await check_stream(bench, operands(bench), INPUTS, OUTPUTS, bench.twin.process)
    bench.finish(at_least=2000)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    items = operands(bench)
    await check_gaps_and_resets(bench, items, INPUTS, OUTPUTS, bench.twin.process)


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, INPUTS, OUTPUTS, bench.twin.process)


def properties(twin):
    """Proved properties, whatever drives it."""
    return [
        pipeline(
            twin,
            (
                (r"delay0_taps\[0\] <= in_valid", "delay0_taps[0] <= (in_valid || delay0_taps[0])"),
                (r"out_valid <= delay0_taps\[\(2 - 1\)\]", "out_valid <= delay0_taps[0]"),
                (r"delay0_taps\[1\] <= 0;", ""),
            ),
        ),
    ]
