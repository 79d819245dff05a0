"""constant_matrix, all sums of a layer, against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sample alone), the frames that drive
each sum to its ends and to either side of where it saturates, and 1000 random frames.
Drives: a frame every clock.
Checks: every result bit for bit, and its clock.
Does not prove: anything about valid flags or reset; the block has neither.
"""

import cocotb
import numpy as np

from golden.layers.closest import closest
from tb.common.bench import Bench
from tb.common.small import ADDER_GRAPHS
from tb.common.stimulus import corner_frames, extreme_frames

CASES = ADDER_GRAPHS
FAULTS = [
    (r"turned = \(one \+ other\)", "turned = (one - other)"),
    (r"turned = \(one - other\)", "turned = (one - other - 64)"),
    (r"turned = \((\(?-?\d+\)?) \+ one\)", r"turned = (\1 + one + 64)"),
    (r"top == 0\)", "top == 1)"),
]

# What is cut moves a result by a unit or so, so that a sum in the middle of one may miss it.
TRIES = 6


def border_frames(rng, twin):
    """Frames whose results are those about which a row saturates."""
    found = []
    for border in twin.borders:
        if border.unreachable:
            continue
        row = int(border.quantity.removeprefix("result "))
        weights, bias = np.array(twin.weights[row]), twin.biases[row]
        for word in (border.at - 1, border.at) * TRIES:
            middle = (word << twin.out_shift) + ((1 << twin.out_shift) >> 1)
            frame = closest(twin.in_fmt, weights, bias, 0, middle, word == border.at, rng)
            if frame is not None:
                found.append(frame)
    return np.array(found, dtype=np.int64).reshape(-1, twin.inputs)


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, latency = bench.twin, bench.latency
    fmt, inputs, rows = twin.in_fmt, twin.inputs, len(twin.weights)
    random = bench.rng.integers(fmt.low, fmt.high + 1, (1000 + latency, inputs))
    ends = extreme_frames(fmt, twin.weights)
    borders = border_frames(bench.rng, twin)
    driven = np.concatenate([corner_frames(fmt, inputs), ends, borders, random])
    ports = [f"in_data_{k}" for k in range(inputs)]
    results = [f"out_data_{i}" for i in range(rows)]
    recording = await bench.play(dict(zip(ports, driven.T, strict=True)), results)
    # From the first row after the initial ones; by then constants are in their registers.
    at = np.arange(recording.clocks - len(driven), recording.clocks - latency)
    seen = np.stack([recording.signed(port, at) for port in ports], axis=-1)
    for quantity, values in twin.quantities(seen).items():
        bench.meet(quantity, values)
    got = np.stack([recording.signed(port, at + latency) for port in results], axis=-1)
    bench.compare("out_data", got, twin.process(seen), frame=seen)
    bench.finish(at_least=1000)
