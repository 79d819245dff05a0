"""input_integral against its twin: corners, ends and borders of each sum, and recorded frames.

Control signals come as CONTROLLER 1 makes them, in no other order. That no sum overflows is
shown by the proof for every frame.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench, Recording
from tb.common.case_library import cases
from tb.common.recorded_frames import recorded_inputs
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames, spread

CASES = cases("rails")


def stimuli(bench):
    """The frames that are played, as the twin takes them."""
    twin, fmt = bench.twin, bench.twin.in_fmt
    random = bench.rng.integers(fmt.low, fmt.high + 1, (300, twin.inputs))
    ends = extreme_frames(fmt, twin.weights)
    borders, _ = border_frames(bench.rng, twin, twin.weights, twin.biases)
    rounding, _ = rounding_frames(bench.rng, twin, twin.weights, twin.biases)
    corners = corner_frames(fmt, twin.inputs)
    return np.concatenate([corners, ends, borders, rounding, random, *recorded_inputs(bench)])


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    twin, inputs = bench.twin, bench.twin.inputs
    driven = stimuli(bench)
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


def node_timeline(rng: np.random.Generator, items: dict[str, np.ndarray], gap: float):
    """Good frames as columns: the samples, what comes with them, and the control signals.

    items: For each port its values, shape (frames, inputs), which stand in the clock of the sample.
    gap: Probability of an idle clock before each sample.
    """
    count, inputs = items["in_data"].shape
    columns = {name: values.ravel() for name, values in items.items()}
    place = np.tile(np.arange(inputs), count)
    drive = spread(rng, columns | {"place": place}, "valid", gap, tail=6)
    valid, place = drive.pop("valid").astype(bool), drive.pop("place")
    drive["accumulate"] = np.roll(valid, 2).astype(np.int64)
    drive["preset"] = np.roll(valid & (place == 0), 2).astype(np.int64)
    drive["capture"] = np.roll(valid & (place == inputs - 1), 3).astype(np.int64)
    return drive


def captured_rows(recording: Recording, inputs: int):
    """The rows of the samples, shape (frames, inputs), and the rows from which sums are held.

    A product enters the accumulator two clocks after its sample. ``capture`` takes the sum that the
    accumulator holds.
    """
    entered = recording.rows("accumulate") - 2
    first = recording.rows("preset") - 2
    assert np.array_equal(entered[::inputs], first), "preset does not open every frame"
    return entered.reshape(-1, inputs), recording.rows("capture") + 1
