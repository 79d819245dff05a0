"""input_integral against its twin: corners, ends and borders of each sum, and recorded frames.

Control signals come as CONTROLLER 1 makes them, in no other order. That no sum overflows is
shown by the proof for every frame.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_inputs
from tb.common.stimulus import frames_of_layer, spread

CASES = cases("rails")


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, fmt, inputs = bench.twin, bench.twin.in_fmt, bench.twin.inputs
    random = bench.rng.integers(fmt.low, fmt.high + 1, (300, inputs))
    of_sums = frames_of_layer(bench.rng, twin, twin.weights, twin.biases)
    driven = np.concatenate([of_sums, random, *recorded_inputs(bench)])
    place = np.tile(np.arange(inputs), len(driven))
    ports = [f"out_q_{j}" for j in range(twin.hidden)]
    for gap in (0.0, 0.4):
        items = {"in_data": driven.ravel(), "addr": place, "place": place}
        drive = spread(bench.rng, items, "valid", gap, tail=6)
        # A product enters the accumulator two clocks after its sample, and the last of a frame is
        # in the sum one clock later.
        valid, at = drive.pop("valid").astype(bool), drive.pop("place")
        drive["accumulate"] = np.roll(valid, 2).astype(np.int64)
        drive["preset"] = np.roll(valid & (at == 0), 2).astype(np.int64)
        drive["capture"] = np.roll(valid & (at == inputs - 1), 3).astype(np.int64)
        recording = await bench.play(drive, ports)
        samples = recording.rows("accumulate") - 2
        first = recording.rows("preset") - 2
        assert np.array_equal(samples[::inputs], first), "preset does not open every frame"
        held = recording.rows("capture") + 1
        bench.compare("addr", recording.unsigned("addr", samples), place)
        seen = recording.signed("in_data", samples).reshape(-1, inputs)
        expected = twin.process(seen)
        for quantity, sums in twin.quantities(seen).items():
            bench.meet(quantity, sums)
        # Each sum is compared in its first clock and in the last clock before the next sum.
        for rows in (held, np.append(held[1:] - 1, recording.clocks - 1)):
            got = np.stack([recording.signed(port, rows) for port in ports], axis=-1)
            bench.compare("out_q", got, expected, frame=seen)
    bench.finish(at_least=4 * len(driven))
