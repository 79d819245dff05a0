"""input_integral against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sensor alone) and 300 random frames.
Drives: samples with address and controls as CONTROLLER 1 makes them, back to back and with gaps.
Checks: the held sums of all nodes bit for bit, from the clock after ``capture``.
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
    nodes = bench.twin.nodes
    fmt, inputs = nodes[0].in_fmt, bench.twin.inputs
    random = bench.rng.integers(fmt.low, fmt.high + 1, (300, inputs))
    driven = np.concatenate([corner_frames(fmt, inputs), random])
    ports = [f"out_q_{j}" for j in range(len(nodes))]
    for gap in (0.0, 0.4):
        drive = node_timeline(bench.rng, driven, gap)
        recording = await bench.play(drive, ports)
        seen, held = captured_frames(recording, inputs)
        got = np.stack([recording.signed(port, held) for port in ports], axis=-1)
        bench.compare("out_q", got, bench.twin.process(seen), frame=seen)
    bench.finish(at_least=2 * len(driven))
