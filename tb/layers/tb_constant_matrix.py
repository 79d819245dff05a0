"""constant_matrix, all sums of a layer, against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sample at a rail), the frames that drive
each sum to both of its ends and to either side of the borders at which it saturates or is
rectified, frames whose sums lie half way between an even and an odd result, where halves go to the
even one, and 1000 random frames.
Drives: a frame every clock.
Checks: every result bit for bit, and the clock in which it appears.
Does not prove: anything about valid flags or reset; the block has neither.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import ADDER_GRAPHS
from tb.common.stimulus import corner_frames, extreme_frames

CASES = ADDER_GRAPHS
# ReLUs, and halves that go to the even code; sums of three operands.
ALSO = ("exact-graph", "operands-graph")
RANDOM = 1000


def border_frames(twin):
    """Frames whose sums lie at the borders of a row: where it saturates, and half way."""
    found = [
        twin.beside(int(border.quantity.removeprefix("result ")), border.at)
        for border in twin.borders
        if not border.unreachable and border.quantity.startswith("result ")
    ]
    found += [twin.ties(i) for i, finish in enumerate(twin.row_finishes) if finish.even]
    return np.concatenate([np.empty((0, twin.inputs), dtype=np.int64), *found])


def stimuli(bench):
    """The frames that are played, as the twin takes them."""
    twin, rng, fmt = bench.twin, bench.rng, bench.twin.in_fmt
    count = RANDOM + bench.latency
    random = rng.integers(fmt.low, fmt.high + 1, (count, twin.inputs))
    low, high = np.array(twin.sample_ends).T
    if twin.in_ends:
        random = rng.integers(low, high + 1, (count, twin.inputs))
    corners = [corner_frames(fmt, twin.inputs), extreme_frames(fmt, twin.weights)]
    within = [np.clip(frames, low, high) for frames in corners]
    return [(np.concatenate([*within, border_frames(twin), random]),)]


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, latency = bench.twin, bench.latency
    ((driven,),) = stimuli(bench)
    ports = [f"in_data_{k}" for k in range(twin.inputs)]
    results = [f"out_data_{i}" for i in range(len(twin.weights))]
    recording = await bench.play(dict(zip(ports, driven.T, strict=True)), results)
    # The initial rows are skipped, so that constants are in their registers.
    at = np.arange(recording.clocks - len(driven), recording.clocks - latency)
    seen = np.stack([recording.signed(port, at) for port in ports], axis=-1)
    for quantity, values in twin.quantities(seen).items():
        bench.meet(quantity, values)
    got = np.stack([recording.signed(port, at + latency) for port in results], axis=-1)
    bench.compare("out_data", got, twin.process(seen), frame=seen)
    bench.finish(at_least=RANDOM)
