"""input_integral against its twin.

Sweeps: corner frames (rails, alternating rails, zeros, one sensor at a rail), the frames that drive
each sum to both of its ends and to either side of the borders at which it saturates, 300 random
frames, and the recorded frames as they reach the layer.
Drives: samples with the address and the control signals of CONTROLLER 1, back to back and with
gaps.
Checks: the held sums of all nodes bit for bit, from the clock after ``capture`` to the next
``capture``.
Does not prove: what control signals do in an order that CONTROLLER 1 never makes.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.frames import captured_rows, node_timeline
from tb.common.recorded_frames import recorded_inputs
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames

CASES = PARTS


def stimuli(bench):
    """The frames that are played, as the twin takes them."""
    twin, fmt = bench.twin, bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (300, twin.inputs))
    ends = extreme_frames(fmt, twin.weights)
    borders, _ = border_frames(bench.rng, twin, twin.weights, twin.biases)
    rounding, _ = rounding_frames(bench.rng, twin, twin.weights, twin.biases)
    corners = corner_frames(fmt, twin.inputs)
    return [(np.concatenate([corners, ends, borders, rounding, random, *recorded_inputs(bench)]),)]


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, inputs = bench.twin, bench.twin.inputs
    ((driven,),) = stimuli(bench)
    addr = np.tile(np.arange(inputs), (len(driven), 1))
    ports = [f"out_q_{j}" for j in range(bench.twin.hidden)]
    for gap in (0.0, 0.4):
        drive = node_timeline(bench.rng, {"in_data": driven, "addr": addr}, gap)
        recording = await bench.play(drive, ports)
        samples, held = captured_rows(recording, inputs)
        bench.compare("addr", recording.unsigned("addr", samples.ravel()), addr.ravel())
        seen = recording.signed("in_data", samples.ravel()).reshape(samples.shape)
        expected = twin.process(seen)
        for quantity, sums in twin.quantities(seen).items():
            bench.meet(quantity, sums)
        # Each sum is compared in its first clock and in the last clock before the next sum.
        for rows in (held, np.append(held[1:] - 1, recording.clocks - 1)):
            got = np.stack([recording.signed(port, rows) for port in ports], axis=-1)
            bench.compare("out_q", got, expected, frame=seen)
    bench.finish(at_least=4 * len(driven))
