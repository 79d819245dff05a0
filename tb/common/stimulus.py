"""Codes and timelines that several benches drive."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from golden.layers.weighted_sum import WeightedSum, beside
from golden.numbers.fixed import Fix
from golden.trained.window import Window

EXHAUSTIVE_WIDTH = 14
STRATA = 16384
# More clocks than the counter of any stream block counts.
LONG_IDLE = 150
LONG_IDLES = 3


def all_codes(fmt: Fix, borders: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Every code of a format of up to 14 bits; of a wider one, a random code of each of 16384
    strata.

    The neighbourhood of every border, of zero and of both ends is always included. So are the codes
    that differ from these in one bit, which reveal a comparison that ignores a bit.
    """
    if fmt.width <= EXHAUSTIVE_WIDTH:
        codes = np.arange(fmt.low, fmt.high + 1)
    else:
        step = (fmt.high - fmt.low + 1) // STRATA
        codes = np.arange(fmt.low, fmt.high + 1, step) + rng.integers(0, step, STRATA)
    marks = np.concatenate([[fmt.low, fmt.high, 0], borders, -np.asarray(borders)])
    near = (marks.astype(np.int64)[:, np.newaxis] + np.arange(-2, 3)).ravel()
    one_bit = (near[:, np.newaxis] ^ (1 << np.arange(fmt.width))).ravel()
    marked = np.unique(np.concatenate([near, one_bit]))
    return np.concatenate([codes, marked[(marked >= fmt.low) & (marked <= fmt.high)]])


def activation_codes(bench: Any, *more: np.ndarray) -> dict[str, np.ndarray]:
    """Codes of an activation over the whole range and about each border, and some more."""
    twin = bench.twin
    return {
        "in_data": np.concatenate([all_codes(twin.in_fmt, twin.border_codes, bench.rng), *more])
    }


def spread(
    rng: np.random.Generator,
    items: dict[str, np.ndarray],
    valid: str,
    gap: float,
    tail: int,
    pause: np.ndarray | int = 0,
) -> dict[str, np.ndarray]:
    """The items in their order, at most one in a clock, with idle clocks between them.

    items: For each port its values, all of one length.
    valid: The port that is high in the clocks of items.
    gap: The probability of an idle clock before each item. In idle clocks the ports carry values of
        other items, which reveals a block that ignores ``valid``. If there are gaps, a few of them
        are longer than any counter counts.
    tail: The least number of idle clocks at the end, which reveal a counter that does not stop.
    pause: The number of further idle clocks before each item.
    """
    count = len(next(iter(items.values())))
    idle = rng.geometric(1 - gap, count) - 1 + pause
    if gap:
        idle[rng.integers(1, count, LONG_IDLES)] += LONG_IDLE
    at = np.cumsum(idle + 1) - 1
    length = at[-1] + 1 + max(tail, LONG_IDLE)
    flags = np.zeros(length, dtype=np.int64)
    flags[at] = 1
    timeline = {valid: flags}
    for name, values in items.items():
        column = np.asarray(values)[rng.integers(0, count, length)]
        column[at] = values
        timeline[name] = column
    return timeline


def random_resets(rng: np.random.Generator, length: int, every: int) -> np.ndarray:
    """Resets of one to three clocks, on average one in ``every`` clocks."""
    column = np.zeros(length, dtype=np.int64)
    for start in np.flatnonzero(rng.random(length) < 1 / every):
        column[start : start + rng.integers(1, 4)] = 1
    return column


def resets_before(rng: np.random.Generator, length: int, every: int, tail: int) -> np.ndarray:
    """Random resets, of which there is at least one, and none in the last ``tail`` clocks."""
    column = random_resets(rng, length, every)
    column[length - tail :] = 0
    if not column.any():
        column[rng.integers(0, length - tail)] = 1
    return column


def corner_frames(fmt: Fix, inputs: int) -> np.ndarray:
    """Frames of rails, of alternating rails, of zeros, and of one sensor at a rail."""
    low, high = fmt.low, fmt.high
    alternating = np.where(np.arange(inputs) % 2, low, high)
    frames = [np.full(inputs, c) for c in (low, high, 0, -1, 1, low + 1)]
    frames += [alternating, np.where(alternating == low, high, low)]
    for k in range(inputs):
        for rail in (low, high):
            frame = np.zeros(inputs, dtype=np.int64)
            frame[k] = rail
            frames.append(frame)
    return np.array(frames, dtype=np.int64)


def extreme_frames(fmt: Fix, weights: np.ndarray) -> np.ndarray:
    """For each row of weights, the two frames that drive its sum to its ends."""
    rows = np.asarray(weights)
    upper = np.where(rows > 0, fmt.high, fmt.low)
    return np.concatenate([upper, np.where(rows > 0, fmt.low, fmt.high)])


def _about(
    layer: WeightedSum,
    row: Sequence[int],
    bias: int,
    at: int,
    near: int,
    rng: np.random.Generator,
) -> list[np.ndarray]:
    """Frames whose sums are closest to the ``near`` values on each side of a border."""
    targets = [(target, target >= at) for target in range(at - near, at + near)]
    frames = [layer.closest(row, bias, target, above, rng) for target, above in targets]
    return [frame for frame in frames if frame is not None]


def with_past(window: Window, rows: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Frames in the order of time, from which a network takes ``rows``, shape (rows, taps).

    Each row has a past of its own, and they follow one another. Samples that are not taken are
    random.
    """
    frames = rng.choice(rows.ravel(), (len(rows), window.past + 1, len(window.delays)))
    for column, tap in enumerate(window.taps):
        frames[:, window.past - tap.delay, tap.sensor] = rows[:, column]
    return frames.reshape(-1, len(window.delays))


def frames_of_layer(
    rng: np.random.Generator,
    layer: WeightedSum,
    rows: Sequence[Sequence[int]],
    biases: Sequence[int],
    factors: Sequence[int] | None = None,
    count: int = 20,
) -> np.ndarray:
    """Frames at corners, and at the ends, the borders and the roundings of each sum of a layer.

    Exact sums lie just at the borders where results saturate. Others are the last that round to one
    result, or the first to round to the next: there an error in the least bit of a sum changes the
    result, and hardly anywhere else. These results are random ones, and those that differ in one
    bit from the largest or the least.

    count: The number of random results for each row of weights.
    """
    fmt, shift, weights = layer.out_fmt, layer.out_shift, np.array(rows)
    chosen = [1] * len(rows) if factors is None else factors
    found = [*corner_frames(layer.in_fmt, len(rows[0])), *extreme_frames(layer.in_fmt, weights)]
    for row, bias, factor in zip(rows, biases, chosen, strict=True):
        for border in layer.borders_of("sum", row, bias, factor):
            if not border.unreachable:
                # First the samples that the twin has found, then others.
                found += list(beside(layer, tuple(row), bias, border.at))
                found += _about(layer, row, bias, border.at, 2, rng)

    starts = np.array(biases) << layer.bias_shift
    ends = (weights[..., np.newaxis] * [layer.in_fmt.low, layer.in_fmt.high]) >> layer.product_shift
    low, high = (
        np.clip(((starts + side.sum(axis=1)) * np.array(chosen)) >> shift, fmt.low, fmt.high)
        for side in (ends.min(axis=2), ends.max(axis=2))
    )
    pairs = [
        (row, int(result))
        for row in range(len(rows))
        for result in rng.integers(low[row], high[row] + 1, count)
    ]
    for end in (fmt.low, fmt.high):
        for result in end ^ (1 << np.arange(fmt.width - 1)):
            able = np.flatnonzero((low <= result) & (result <= high))
            pairs += [(int(row), int(result)) for row in able[:1]]
    for at_row, result in pairs:
        at = -(-((result << shift) - ((1 << shift) >> 1)) // int(chosen[at_row]))
        found += _about(layer, rows[at_row], int(biases[at_row]), at, 1, rng)
    return np.array(found, dtype=np.int64)
