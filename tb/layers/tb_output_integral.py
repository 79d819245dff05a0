"""output_integral against its twin.

Sweeps: corner frames of activations (rails, alternating rails, zeros, one node at a rail), frames
that drive each sum to both of its ends and to either side of the borders at which it saturates, and
1000 random frames, each with every output row.
Drives: rows as CONTROLLER 2 makes them, back to back, then with gaps and resets; then, back to
back, the inputs that the block gets while the recorded frames run through the design.
Checks: every output and its ``last`` bit for bit, and the clock in which they appear.
Does not prove: what a row address beyond the last output does.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.recorded_frames import check_recorded, recorded_inputs
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames
from tb.common.stream import SIGNED, UNSIGNED, check_stream

CASES = PARTS

OUTPUTS = {"out_data": SIGNED, "out_last": UNSIGNED}


def rows_of(twin, frames):
    """Each output row with its ``last`` and the activations, for every frame."""
    rows = np.tile(np.arange(twin.outputs), len(frames))
    last = (rows == twin.outputs - 1).astype(np.int64)
    return rows, last, *np.repeat(frames, twin.outputs, axis=0).T


def ports_in(twin):
    ports = {"in_addr": UNSIGNED, "in_last": UNSIGNED}
    return ports | {f"in_r_{j}": SIGNED for j in range(twin.hidden)}


def expected(twin):
    def of_rows(addr, last, *activations):
        results = twin.process(np.stack(activations, axis=-1))
        return results[np.arange(len(addr)), addr], last

    return of_rows


async def check(bench, operands, gap, resets):
    twin, inputs = bench.twin, ports_in(bench.twin)
    items = dict(zip(inputs, operands, strict=True))
    await check_stream(bench, items, inputs, OUTPUTS, expected(twin), gap=gap, resets=resets)
    bench.finish(at_least=len(operands[0]) // twin.outputs)


def stimuli(bench, count=1000):
    """Rows and activations, as the block takes them, with ``count`` random frames among them."""
    fmt = bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (count, bench.twin.hidden))
    ends = extreme_frames(fmt, bench.twin.weights)
    twin = bench.twin
    borders, _ = border_frames(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    rounding, _ = rounding_frames(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    frames = np.concatenate([corner_frames(fmt, twin.hidden), ends, borders, rounding, random])
    return [rows_of(twin, frames)]


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    (operands,) = stimuli(bench)
    await check(bench, operands, gap=0.0, resets=False)


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    (frames,) = recorded_inputs(bench)
    operands = rows_of(bench.twin, frames)
    await check_recorded(bench, ports_in(bench.twin), OUTPUTS, expected(bench.twin), operands)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    (operands,) = stimuli(bench, count=400)
    await check(bench, operands, gap=0.3, resets=True)
