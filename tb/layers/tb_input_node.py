"""input_node against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sensor alone), the frames
that drive each sum to its ends, and 500 random frames.
Drives: samples with address and controls as CONTROLLER 1 makes them, back to back and with gaps.
Checks: the held sum of every frame bit for bit, from the clock after ``capture`` to the next one.
Does not prove: controls in an order that CONTROLLER 1 never makes.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.frames import captured_frames, node_timeline
from tb.common.small import PARTS
from tb.common.stimulus import corner_frames, extreme_frames

CASES = PARTS
FAULTS = [
    (r"if \(capture\)", "if (1)"),
    (r"result = 131071|result = 8191", "result = 0"),
    (r"acc \+ (\d+)", "acc + 0"),
]


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    fmt, inputs = bench.twin.in_fmt, len(bench.twin.weights)
    random = bench.rng.integers(fmt.low, fmt.high + 1, (500, inputs))
    ends = extreme_frames(fmt, [bench.twin.weights])
    driven = np.concatenate([corner_frames(fmt, inputs), ends, random])
    for gap in (0.0, 0.4):
        drive = node_timeline(bench.rng, driven, gap)
        recording = await bench.play(drive, ["out_data"])
        seen, held = captured_frames(recording, inputs)
        expected = bench.twin.process(seen)
        # The first clock of every sum, and the last one before the next sum.
        for rows in (held, np.append(held[1:] - 1, recording.clocks - 1)):
            got = recording.signed("out_data", rows)
            bench.compare("out_data", got, expected, frame=seen)
    bench.finish(at_least=4 * len(driven))
