"""input_node against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sensor alone) and 500 random frames.
Drives: samples with address and controls as CONTROLLER 1 makes them, back to back and with gaps.
Checks: the held sum of every frame bit for bit, from the clock after ``capture``.
Does not prove: controls in an order that CONTROLLER 1 never makes.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.frames import captured_frames, node_timeline
from tb.common.stimulus import corner_frames


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    fmt, inputs = bench.twin.in_fmt, len(bench.twin.weights)
    random = bench.rng.integers(fmt.low, fmt.high + 1, (500, inputs))
    driven = np.concatenate([corner_frames(fmt, inputs), random])
    for gap in (0.0, 0.4):
        drive = node_timeline(bench.rng, driven, gap)
        recording = await bench.play(drive, ["out_data"])
        seen, held = captured_frames(recording, inputs)
        got = recording.signed("out_data", held)
        bench.compare("out_data", got, bench.twin.process(seen), frame=seen)
    bench.finish(at_least=2 * len(driven))
