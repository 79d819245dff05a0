"""neuron against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sample at a rail), the frames that drive
the sum to both of its ends and to either side of the borders at which it saturates, and 1000 random
frames.
Drives: a frame every clock.
Checks: every result bit for bit, and the clock in which it appears.
Does not prove: anything about valid flags or reset; the block has neither.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import PARALLEL
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames

CASES = {name: PARALLEL[name] for name in ("rails-parallel", "least-parallel", "pade-parallel")}


def stimuli(bench):
    """The frames that are played, as the twin takes them."""
    twin = bench.twin
    fmt, inputs = twin.in_fmt, len(twin.weights)
    random = bench.rng.integers(fmt.low, fmt.high + 1, (1000 + bench.latency, inputs))
    ends = extreme_frames(fmt, [twin.weights])
    borders, _ = border_frames(bench.rng, twin, [twin.weights], [twin.bias], [twin.factor or 1])
    rounding, _ = rounding_frames(bench.rng, twin, [twin.weights], [twin.bias], [twin.factor or 1])
    return [(np.concatenate([corner_frames(fmt, inputs), ends, borders, rounding, random]),)]


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, latency = bench.twin, bench.latency
    ((driven,),) = stimuli(bench)
    ports = [f"in_data_{k}" for k in range(len(twin.weights))]
    recording = await bench.play(dict(zip(ports, driven.T, strict=True)), ["out_data"])
    # The initial rows are skipped, so that the bias is in its register.
    rows = np.arange(recording.clocks - len(driven), recording.clocks - latency)
    seen = np.stack([recording.signed(port, rows) for port in ports], axis=-1)
    bench.meet("sum", twin.exact(seen))
    got = recording.signed("out_data", rows + latency)
    bench.compare("out_data", got, twin.process(seen), frame=seen)
    bench.finish(at_least=1000)
