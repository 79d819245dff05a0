"""input_node against its twin.

Sweeps: with the weights of every node of the design: corner frames (rails, alternating rails,
zeros, one sensor at a rail), the frames that drive the sum to both of its ends, frames on either
side of the borders at which it saturates or rounds to another result, and the recorded frames as
they reach the layer. Then 500 random frames, each with weights and a bias of its own; and each end
of a single weight and of the bias alone. With weights whose sums just fill the accumulator there
are as many samples as that takes, the same borders, and both ends.
Drives: samples and weights with the control signals of CONTROLLER 1, back to back and with gaps.
The bias is on its port only in clocks of ``preset``; in other clocks the port carries another
value.
Checks: the held sum of every frame bit for bit, from the clock after ``capture`` to the next
``capture``.
Does not prove: what control signals do in an order that CONTROLLER 1 never makes; what weights do
with which a sum could overflow the accumulator.
"""

import cocotb
import numpy as np

from golden.layers.input_integral import InputIntegral
from tb.common.bench import Bench
from tb.common.case_library import PARTS
from tb.common.frames import captured_rows, node_timeline
from tb.common.recorded_frames import recorded_inputs
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames

CASES = PARTS
RANDOM = 500
# At most so many sums of recorded frames are compared, over all nodes of a layer.
RECORDED = 1000


def random_coefficients(bench, inputs):
    """Weights and biases of every magnitude that the block must handle."""
    twin, rng = bench.twin, bench.rng
    fmt = twin.coeff_fmt
    weights = rng.integers(fmt.low, fmt.high + 1, (RANDOM, inputs))
    biases = rng.integers(fmt.low, fmt.high + 1, RANDOM)
    while not (held := twin.holds(weights, biases)).all():
        for codes in (weights, biases):
            codes[~held] = np.sign(codes[~held]) * (np.abs(codes[~held]) // 2)
    return weights, biases


def end_coefficients(bench, inputs):
    """Frames with one weight or the bias alone, at each end that the accumulator can hold."""
    twin, fmt = bench.twin, bench.twin.coeff_fmt
    weights, biases = [], []
    for end in (fmt.low, fmt.high):
        if f"weight={end}" not in twin.unreachable:
            weights += [np.eye(inputs, dtype=np.int64)[k] * end for k in range(inputs)]
            biases += [0] * inputs
        if f"bias={end}" not in twin.unreachable:
            weights.append(np.zeros(inputs, dtype=np.int64))
            biases.append(end)
    frames = bench.rng.integers(twin.in_fmt.low, twin.in_fmt.high + 1, (len(biases), inputs))
    found = np.array(weights, dtype=np.int64).reshape(-1, inputs)
    return frames, found, np.array(biases, dtype=np.int64)


def marked(bench, rows, biases, count):
    """Frames at the borders at which sums of rows saturate or round to another result."""
    pairs = [
        border_frames(bench.rng, bench.twin, rows, biases),
        rounding_frames(bench.rng, bench.twin, rows, biases, count=count),
    ]
    frames, chosen = (np.concatenate(column) for column in zip(*pairs, strict=True))
    return frames, np.array(rows)[chosen], np.array(biases)[chosen]


def of_layer(bench, layer):
    """Frames with as many samples as a layer takes, and the weights and bias of each frame."""
    fmt, inputs = bench.twin.in_fmt, layer.inputs
    coefficients = random_coefficients(bench, inputs)
    parts = [(bench.rng.integers(fmt.low, fmt.high + 1, (RANDOM, inputs)), *coefficients)]
    for row, bias in zip(layer.weights, layer.biases, strict=True):
        frames = np.concatenate([corner_frames(fmt, inputs), extreme_frames(fmt, [row])])
        count = len(frames)
        parts.append((frames, np.tile(row, (count, 1)), np.full(count, bias)))
    (recordings,) = recorded_inputs(bench, layer, most=max(1, RECORDED // layer.hidden))
    node = np.repeat(np.arange(layer.hidden), len(recordings))
    rows, biases = np.array(layer.weights)[node], np.array(layer.biases)[node]
    parts.append((np.tile(recordings, (layer.hidden, 1)), rows, biases))
    parts.append(marked(bench, layer.weights, layer.biases, count=5))
    parts.append(end_coefficients(bench, inputs))
    return joined(parts)


def widest(twin, above):
    """Weights and a bias whose largest or least sum is just the end of the accumulator.

    The bias makes up half of it, if a bias can be that large. One weight is 1 and another is no
    larger than the magnitude of the least sample, so that every sum up to the end occurs.
    """
    fmt, most = twin.coeff_fmt, 1 << (twin.acc_width - 1)
    room = most - 1 if above else most
    bias = min(fmt.high, room >> twin.bias_shift >> 1)
    room -= bias << twin.bias_shift
    # The weights with which the least sample reaches the end.
    left = room // (-twin.in_fmt.low >> twin.product_shift)
    sizes = []
    for size in (1, -twin.in_fmt.low):
        sizes.append(min(left, size, fmt.high))
        left -= sizes[-1]
    while left:
        sizes.append(min(left, fmt.high))
        left -= sizes[-1]
    row, bias = np.array(sizes) * (-1 if above else 1), bias if above else -bias
    # The largest sample with a weight of the other sign is one bit short of the end.
    longer = np.append(row, 1 if above else -1)
    return (longer if twin.holds(longer, bias) else row), bias


def whole_range(bench):
    """Frames whose sums reach the ends of the accumulator, with as many samples as that takes."""
    twin, half = bench.twin, 1 << (bench.twin.acc_width - 1)
    found = []
    for above in (False, True):
        row, bias = widest(twin, above)
        found.append(marked(bench, [row], [bias], count=20))
        for target in (half - 2, half - 1) if above else (-half, 1 - half):
            start = bias << twin.bias_shift
            frame = twin.closest(row, start, target, not above, bench.rng)
            if frame is not None:
                found.append((frame[np.newaxis], row[np.newaxis], np.array([bias])))
    length = max(frames.shape[1] for frames, _, _ in found)

    def padded(codes):
        return np.pad(codes, ((0, 0), (0, length - codes.shape[1])))

    return joined([(padded(frames), padded(rows), biases) for frames, rows, biases in found])


def joined(parts):
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


def stimuli(bench):
    """Frames with their weights and biases. The frames of a part have equally many samples."""
    return [
        *(of_layer(bench, layer) for layer in bench.around(InputIntegral)),
        whole_range(bench),
    ]


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    fmt = bench.twin.coeff_fmt
    planned = stimuli(bench)
    for driven, weights, biases in planned:
        others = bench.rng.integers(fmt.low, fmt.high + 1, weights.shape)
        others[:, 0] = biases
        items = {"in_data": driven, "weight": weights, "bias": others}
        for gap in (0.0, 0.4):
            drive = node_timeline(bench.rng, items, gap)
            drive["bias"] = np.roll(drive["bias"], 2)
            recording = await bench.play(drive, ["out_data"])
            samples, held = captured_rows(recording, weights.shape[1])
            seen, factors = (
                recording.signed(port, samples.ravel()).reshape(samples.shape)
                for port in ("in_data", "weight")
            )
            starts = recording.signed("bias", recording.rows("preset"))
            expected = bench.twin.process(seen, factors, starts)
            bench.meet("sum", bench.twin.exact(seen, factors, starts))
            # Each sum is compared in its first clock and in the last clock before the next sum.
            for rows in (held, np.append(held[1:] - 1, recording.clocks - 1)):
                got = recording.signed("out_data", rows)
                bench.compare("out_data", got, expected, frame=seen)
    bench.finish(at_least=4 * sum(len(driven) for driven, _, _ in planned))
