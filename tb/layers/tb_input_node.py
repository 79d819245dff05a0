"""input_node against its twin.

Sweeps: with the weights of every node that the design has, corner frames (rails, alternating rails,
zeros, one sensor alone) and the frames that drive the sum to its ends; 500 random frames, each with
weights and a bias of its own; with the weights of every node, and with the largest at random,
frames on either side of where the sum saturates, and where it rounds to another result; frames that
bring the sum to the ends of the accumulator.
Drives: samples and weights with the controls as CONTROLLER 1 makes them, back to back and with
gaps; a bias only where ``preset`` asks for it, and something else in other clocks.
Checks: the held sum of every frame bit for bit, from the clock after ``capture`` to the next one.
Does not prove: controls in an order that CONTROLLER 1 never makes; sums that leave the accumulator.
"""

import cocotb
import numpy as np

from golden.block import walk
from golden.layers.input_integral import InputIntegral
from tb.common.bench import Bench
from tb.common.frames import captured_rows, node_timeline
from tb.common.small import PARTS
from tb.common.stimulus import border_frames, corner_frames, extreme_frames, rounding_frames

CASES = PARTS
FAULTS = [
    (r"if \(capture\)", "if (1)"),
    (r"result = 131071|result = 8191", "result = 0"),
    (r"acc \+ (\d+)", "acc + 0"),
    (r"bias_word = bias", "bias_word = 0"),
    (r"factor <= weight", "factor <= bias"),
    (r"kept > 131071", "kept > 131072"),
    (r"kept < \(-131072\)", "kept < (-131073)"),
]
RANDOM = 500


def random_coefficients(bench, inputs):
    """Weights and biases of any magnitude whose sums the accumulator holds."""
    twin, rng = bench.twin, bench.rng
    fmt = twin.coeff_fmt
    weights = rng.integers(fmt.low, fmt.high + 1, (RANDOM, inputs))
    biases = rng.integers(fmt.low, fmt.high + 1, RANDOM)
    while True:
        terms = np.abs(weights * twin.in_fmt.low) >> twin.product_shift
        reach = terms.sum(axis=1) + (np.abs(biases) << twin.bias_shift)
        wide = reach >= 1 << (twin.acc_width - 1)
        if not wide.any():
            return weights, biases
        for codes in (weights, biases):
            codes[wide] = np.sign(codes[wide]) * (np.abs(codes[wide]) // 2)


def end_coefficients(bench, inputs):
    """Frames with a weight or the bias alone, at either end, where the accumulator holds it."""
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


def fine(bench, rows):
    """The same weights, but that the last makes steps of one: sums of every value are reached.

    Of minus one, which every format holds; the weight of plus one may be just beyond its highest.
    """
    return [[*row[:-1], -1 << bench.twin.product_shift] for row in rows]


def accumulator_ends(bench, inputs):
    """Frames whose sums are those at the ends of the accumulator, or as close as weights allow."""
    twin, coeff = bench.twin, bench.twin.coeff_fmt
    row = np.array(fine(bench, [[coeff.high] * inputs])[0])
    parts = []
    for sample, above in ((twin.in_fmt.high, False), (twin.in_fmt.low, True)):
        end = (-1 if above else 1) << (twin.acc_width - 1)
        rest = end - int(((row[:-1] * sample) >> twin.product_shift).sum())
        bias = int(np.clip(rest >> twin.bias_shift, coeff.low, coeff.high))
        for target in (end + 1, end) if above else (end - 2, end - 1):
            parts.append(
                (twin.closest(row, bias << twin.bias_shift, target, above, bench.rng), row, bias)
            )
    return tuple(map(np.array, zip(*parts, strict=True)))


def stimuli(bench, layer):
    """Frames, and the weights and bias of each."""
    fmt, inputs = bench.twin.in_fmt, layer.inputs
    weights, biases = random_coefficients(bench, inputs)
    parts = [(bench.rng.integers(fmt.low, fmt.high + 1, (RANDOM, inputs)), weights, biases)]
    for row, bias in zip(layer.weights, layer.biases, strict=True):
        frames = np.concatenate([corner_frames(fmt, inputs), extreme_frames(fmt, [row])])
        count = len(frames)
        parts.append((frames, np.tile(row, (count, 1)), np.full(count, bias)))
    # The weights of the nodes need not reach what the accumulator holds; these do.
    reach = (np.abs(weights * fmt.low) >> bench.twin.product_shift).sum(axis=1)
    widest = int(np.argmax(reach))
    rows = [*map(list, layer.weights), weights[widest].tolist()]
    offsets = [*layer.biases, int(biases[widest])]
    frames, chosen = border_frames(bench.rng, bench.twin, rows, offsets)
    parts.append((frames, np.array(rows)[chosen], np.array(offsets)[chosen]))
    rows = fine(bench, rows)
    frames, chosen = rounding_frames(bench.rng, bench.twin, rows, offsets, count=5)
    parts.append((frames, np.array(rows)[chosen], np.array(offsets)[chosen]))
    parts.append(accumulator_ends(bench, inputs))
    parts.append(end_coefficients(bench, inputs))
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


@cocotb.test()
async def frames(dut):
    bench = Bench(dut)
    layers = [block for block in walk(bench.design) if isinstance(block, InputIntegral)]
    fmt = bench.twin.coeff_fmt
    for layer in (block for block in layers if block.node == bench.twin):
        driven, weights, biases = stimuli(bench, layer)
        others = bench.rng.integers(fmt.low, fmt.high + 1, weights.shape)
        others[:, 0] = biases
        items = {"in_data": driven, "weight": weights, "bias": others}
        for gap in (0.0, 0.4):
            drive = node_timeline(bench.rng, items, gap)
            drive["bias"] = np.roll(drive["bias"], 2)
            recording = await bench.play(drive, ["out_data"])
            samples, held = captured_rows(recording, layer.inputs)
            seen, factors = (
                recording.signed(port, samples.ravel()).reshape(samples.shape)
                for port in ("in_data", "weight")
            )
            starts = recording.signed("bias", recording.rows("preset"))
            expected = bench.twin.process(seen, factors, starts)
            bench.meet("sum", bench.twin.exact(seen, factors, starts))
            # The first clock of every sum, and the last one before the next sum.
            for rows in (held, np.append(held[1:] - 1, recording.clocks - 1)):
                got = recording.signed("out_data", rows)
                bench.compare("out_data", got, expected, frame=seen)
    bench.finish(at_least=4 * RANDOM)
