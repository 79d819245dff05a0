"""frame_window against its twin: frames of all lengths, close and closer, with gaps and resets.

No sample leaves before the past is complete, and none of a wrong frame. What is in the slots after
the samples has no effect.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench, test_of
from tb.common.case_library import cases
from tb.common.framing import random_lengths, scan, whole, yielding
from tb.common.stimulus import corner_frames, random_resets, spread
from tb.sensing.window_proof import window

CASES = cases("windows")
# A case without a least distance of frames, and with slots after the samples.
PROVED = ("chain-past",)


# About how many clocks a test plays.
MOST_CLOCKS = 20_000


async def check(bench, data, last, gap=0.0, pause=0, resets=None):
    """Play samples and compare; ``resets`` gives the reset column for a number of clocks."""
    twin = bench.twin
    items = {"in_data": data, "in_last": last}
    tail = twin.latency + twin.elements + 3
    drive = spread(bench.rng, items, "in_valid", gap, tail, pause=pause)
    if resets is not None:
        drive["rst"] = resets(len(drive["in_valid"]))
    recording = await bench.play(drive, ["out_valid", "out_data", "out_last", "frame_error"])

    rows, frames = scan(twin.input_controller, recording)
    done = np.flatnonzero(frames.done)
    samples = recording.signed("in_data", rows)
    good = samples[done[:, np.newaxis] + np.arange(1 - twin.sensors, 1)]
    started, ended = rows[done - twin.sensors + 1], rows[done]
    kept, expected = yielding(recording, ended, good, twin.past, twin.process)
    at = ended[kept, np.newaxis] + bench.latency + np.arange(twin.elements)
    begun = np.repeat(started[kept], twin.elements).reshape(at.shape)
    alive = recording.undisturbed(begun, at - 1)
    bench.compare("clocks of out_valid", recording.rows("out_valid"), at[alive])
    bench.compare("clocks of out_last", recording.rows("out_last"), at[:, -1][alive[:, -1]])
    taps = slice(len(twin.window.taps))
    left = alive[:, taps]
    got = recording.signed("out_data", at[:, taps][left])
    bench.compare("out_data", got, expected[left], clock=at[:, taps][left])
    bench.compare("clocks of frame_error", recording.rows("frame_error"), rows[frames.error] + 1)
    return frames, kept


def random_data(bench, count):
    fmt = bench.twin.fmt
    return bench.rng.integers(fmt.low, fmt.high + 1, count)


def random_frames(bench, count):
    return random_data(bench, count * bench.twin.sensors).reshape(count, -1)


def enough(bench):
    """How many frames fill the ring three times, or once if that takes long, after a past."""
    once = bench.twin.words // bench.twin.sensors
    return bench.twin.past + 3 + min(3 * once, max(once, MOST_CLOCKS // bench.twin.interval))


def closest(bench):
    """The idle clocks before a frame with which frames are as close as allowed."""
    return bench.twin.interval - bench.twin.sensors


@cocotb.test()
async def frames_in_time(dut):
    """Play rails and random codes in the past, as close as allowed and with gaps."""
    bench = Bench(dut)
    twin = bench.twin
    count = enough(bench)
    for gap in (0.0, 0.3):
        corners = bench.rng.choice(corner_frames(twin.fmt, twin.sensors), count)
        at_random = bench.rng.random((count, 1)) < 0.5
        data, last = whole(np.where(at_random, random_frames(bench, count), corners))
        _, kept = await check(bench, data, last, gap, np.roll(last, 1) * closest(bench))
        assert kept.sum() == count - twin.past, "not every frame was taken"
    bench.finish(at_least=2 * twin.elements * (count - twin.past))


@cocotb.test()
async def wrong_frames(dut):
    """Play frames that are too short, too long or too close. None of them enters the past."""
    bench = Bench(dut)
    twin = bench.twin
    for gap in (0.0, 0.3):
        last = random_lengths(bench.rng, twin.sensors, 2 * twin.sensors * enough(bench))
        # One frame in four has the right length but is too close.
        close = bench.rng.integers(0, closest(bench) + 1, len(last))
        near = bench.rng.random(len(last)) < 0.25
        pause = np.roll(last, 1) * np.where(near, close, closest(bench))
        frames, kept = await check(bench, random_data(bench, len(last)), last, gap, pause)
        assert frames.error.any(), "no wrong frame was driven"
        assert kept.any(), "no past was ever whole"
    bench.finish(at_least=twin.elements * len(kept) // 8)


@test_of(lambda twin: twin.interval > twin.sensors)
async def too_early(dut):
    """Play good frames, each followed by one that comes 1, 2, 4, ... clocks too early."""
    bench = Bench(dut)
    twin = bench.twin
    early = 2 ** np.arange(closest(bench).bit_length())
    frames = twin.past + 2 * len(early)
    data, last = whole(random_frames(bench, frames))
    pause = np.zeros((frames, twin.sensors), dtype=np.int64)
    pause[:, 0] = closest(bench)
    pause[twin.past + 1 :: 2, 0] -= early
    judged, _ = await check(bench, data, last, pause=pause.ravel())
    assert judged.error.sum() == len(early), "a frame that came too early was taken"
    bench.finish(at_least=len(early))


@cocotb.test()
async def resets(dut):
    """Play resets at random clocks, after which the past begins anew."""
    bench = Bench(dut)
    twin = bench.twin
    last = random_lengths(bench.rng, twin.sensors, 9 * twin.sensors * (twin.past + 9))
    every = 3 * (twin.past + 2) * twin.interval
    _, kept = await check(
        bench,
        random_data(bench, len(last)),
        last,
        gap=0.1,
        pause=np.roll(last, 1) * closest(bench),
        resets=lambda length: random_resets(bench.rng, length, every),
    )
    assert kept.any(), "no past was ever whole"
    bench.finish(at_least=50)


@cocotb.test()
async def reset_at_every_clock(dut):
    """Play a complete past, a reset in a clock of the frame or of what is sent, and a past again.

    This is done for every clock, or with a long past for as many as there is time for.
    """
    bench = Bench(dut)
    twin = bench.twin
    each = (twin.past + 1) * twin.interval
    sent = twin.latency + twin.elements + 2
    after = twin.interval + sent
    newest = after + twin.past * twin.interval
    at = newest + np.arange(twin.interval + sent)
    most = max(4, MOST_CLOCKS // 2 // (each + after))
    if len(at) > most:
        at = np.sort(bench.rng.choice(at, most, replace=False))
    frames = random_frames(bench, len(at) * (twin.past + 1))
    data, last = whole(frames)
    pause = np.zeros((len(at), twin.past + 1, twin.sensors), dtype=np.int64)
    pause[:, :, 0] = closest(bench)
    pause[:, 0, 0] += after

    def resets(clocks):
        column = np.zeros(clocks, dtype=np.int64)
        column[np.arange(len(at)) * (each + after) + at] = 1
        return column

    await check(bench, data, last, pause=pause.ravel(), resets=resets)
    bench.finish(at_least=len(at))


def properties(twin):
    return window(twin, "", "out_")
