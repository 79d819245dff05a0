"""output_integral against its twin: corners, ends and borders of each sum, and recorded frames.

Each comes with every output row, as CONTROLLER 2 makes them, back to back and with gaps and resets.
That no sum overflows is shown by the proof for every frame.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.recorded_frames import check_recorded, recorded_inputs
from tb.common.stimulus import frames_of_layer
from tb.common.stream import check_stream
from tb.common.watch import pipeline

CASES = cases("rails")


def rows_of(twin, frames):
    """Each output row with its ``last`` and the activations, for every frame."""
    rows = np.tile(np.arange(twin.outputs), len(frames))
    last = (rows == twin.outputs - 1).astype(np.int64)
    activations = np.repeat(frames, twin.outputs, axis=0).T
    return {"in_addr": rows, "in_last": last} | {f"in_r_{j}": r for j, r in enumerate(activations)}


def expected(twin):
    def of_rows(addr, last, *activations):
        results = twin.process(np.stack(activations, axis=-1))
        return results[np.arange(len(addr)), addr], last

    return of_rows


async def check(bench, items, gap, resets):
    await check_stream(bench, items, expected(bench.twin), gap, resets)
    bench.finish(at_least=len(items["in_addr"]) // bench.twin.outputs)


def stimuli(bench, count=1000):
    """Rows and activations, as the block takes them, with ``count`` random frames among them."""
    twin, fmt = bench.twin, bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (count, twin.hidden))
    of_sums = frames_of_layer(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    return rows_of(twin, np.concatenate([of_sums, random]))


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    await check(bench, stimuli(bench), gap=0.0, resets=False)


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    (frames,) = recorded_inputs(bench)
    await check_recorded(bench, expected(bench.twin), rows_of(bench.twin, frames))


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check(bench, stimuli(bench, count=400), gap=0.3, resets=True)


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"delay3_taps\[0\] <= in_last", "delay3_taps[0] <= (in_last && in_valid)"),
                (r"delay3_taps\[1\] <= 0;", ""),
                (r"out_valid <= delay2_taps\[\(5 - 1\)\]", "out_valid <= delay2_taps[3]"),
            ),
            last="in_last",
        ),
    ]
