"""constant_matrix, all sums of a layer, against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sample alone), the frames that drive
each sum to its ends and to either side of where it saturates, and 1000 random frames.
Drives: a frame every clock.
Checks: every result bit for bit, and its clock.
Does not prove: anything about valid flags or reset; the block has neither.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.small import ADDER_GRAPHS
from tb.common.stimulus import corner_frames, extreme_frames

CASES = ADDER_GRAPHS
FAULTS = [
    (r"(\w+_one) \+ (\w+_other)", r"\1 - \2"),
]


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, latency = bench.twin, bench.latency
    fmt, inputs, rows = twin.in_fmt, twin.inputs, len(twin.weights)
    random = bench.rng.integers(fmt.low, fmt.high + 1, (1000 + latency, inputs))
    ends = extreme_frames(fmt, twin.weights)
    driven = np.concatenate([corner_frames(fmt, inputs), ends, random])
    ports = [f"in_data_{k}" for k in range(inputs)]
    results = [f"out_data_{i}" for i in range(rows)]
    recording = await bench.play(dict(zip(ports, driven.T, strict=True)), results)
    # From the first row after the initial ones; by then constants are in their registers.
    at = np.arange(recording.clocks - len(driven), recording.clocks - latency)
    seen = np.stack([recording.signed(port, at) for port in ports], axis=-1)
    got = np.stack([recording.signed(port, at + latency) for port in results], axis=-1)
    bench.compare("out_data", got, twin.process(seen), frame=seen)
    bench.finish(at_least=1000)
