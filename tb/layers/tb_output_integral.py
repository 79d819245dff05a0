"""output_integral against its twin.

Sweeps: corner frames of activations (rails, alternating rails, zeros, one node alone), those
that drive each sum to its ends and to either side of where it saturates, and 1000 random ones,
each with every output row.
Drives: rows as CONTROLLER 2 makes them, back to back, then with gaps and resets.
Checks: every output and its ``last`` bit for bit, and its clock.
Does not prove: a row address beyond the last output.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.small import FOLDED
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames
from tb.common.stream import SIGNED, UNSIGNED, check_stream

CASES = FOLDED
FAULTS = [
    (r"left \+ right|(\w+_term) \+ (\w+_term)", r"\1 - \2"),
    (r"out_last <= [a-z][^;]+", "out_last <= 0"),
    (r"kept > 8191", "kept > 8192"),
    (r"kept < \(-8192\)", "kept < (-8193)"),
    (r"out_last <= 0;", "out_last <= in_last;"),
    (r"(delay3_taps\[4\]) <= 0", r"\1 <= \1"),
    (r"(delay2_taps\[0\]) <= 0", r"\1 <= in_valid"),
]


async def check(bench, frames, gap, resets):
    twin = bench.twin
    outputs, hidden = twin.outputs, twin.hidden
    rows = np.tile(np.arange(outputs), len(frames))
    items = {"in_addr": rows, "in_last": (rows == outputs - 1).astype(np.int64)}
    for j in range(hidden):
        items[f"in_r_{j}"] = np.repeat(frames[:, j], outputs)

    def expected(addr, last, *activations):
        frames = np.stack(activations, axis=-1)
        results = twin.process(frames)
        return results[np.arange(len(addr)), addr], last

    inputs = {"in_addr": UNSIGNED, "in_last": UNSIGNED}
    inputs |= {f"in_r_{j}": SIGNED for j in range(hidden)}
    await check_stream(
        bench,
        items,
        inputs,
        {"out_data": SIGNED, "out_last": UNSIGNED},
        expected,
        gap=gap,
        resets=resets,
    )
    bench.finish(at_least=len(frames))


def activations(bench, count):
    fmt = bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (count, bench.twin.hidden))
    ends = extreme_frames(fmt, bench.twin.weights)
    twin = bench.twin
    borders, _ = border_frames(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    rounding, _ = rounding_frames(bench.rng, twin, twin.weights, twin.biases, twin.factors)
    return np.concatenate([corner_frames(fmt, twin.hidden), ends, borders, rounding, random])


@cocotb.test()
async def back_to_back(dut):
    bench = Bench(dut)
    await check(bench, activations(bench, 1000), gap=0.0, resets=False)


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check(bench, activations(bench, 400), gap=0.3, resets=True)
