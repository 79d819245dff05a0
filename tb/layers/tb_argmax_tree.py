"""argmax_tree against its twin.

Sweeps: frames of random outputs with the ends of the codes among them; frames of equal outputs, and
of outputs that are equal or differ by one; frames with each output in turn as the largest and as
the second largest, at both ends of the codes; frames with two distances from the largest that
differ in one bit; for each pair of groups frames in which the largest of one is as large as that of
the other, or one step from it.
Drives: a frame every clock.
Checks: index and margin of every frame, and the clock in which they appear.
Does not prove: anything about valid flags or reset; the block has neither.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import TREES
from tb.layers.tb_argmax import frames_of

CASES = TREES


def rival_frames(bench):
    """Frames in which two groups that meet have about the same largest output."""
    twin, rng = bench.twin, bench.rng
    found = []
    for border in twin.borders:
        one, other = (int(word) for word in border.quantity.split(" less "))
        for apart in (-1, 0, 1):
            frame = rng.integers(twin.fmt.low, 0, (4, twin.outputs))
            frame[:, one] = rng.integers(1, twin.fmt.high, 4)
            frame[:, other] = frame[:, one] - apart
            found.append(frame)
    return np.concatenate(found)


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, latency = bench.twin, bench.latency
    driven = np.concatenate([frames_of(bench), rival_frames(bench)])
    driven = np.concatenate([driven, driven[:latency]])
    ports = [f"in_data_{k}" for k in range(twin.outputs)]
    recording = await bench.play(
        dict(zip(ports, driven.T, strict=True)), ["out_index", "out_margin"]
    )
    at = np.arange(recording.clocks - len(driven), recording.clocks - latency)
    seen = np.stack([recording.signed(port, at) for port in ports], axis=-1)
    for quantity, values in twin.quantities(seen).items():
        bench.meet(quantity, values)
    index, margin = twin.process(seen)
    bench.compare("out_index", recording.unsigned("out_index", at + latency), index, frame=seen)
    bench.compare("out_margin", recording.unsigned("out_margin", at + latency), margin, frame=seen)
    bench.finish(at_least=2 * len(at))
