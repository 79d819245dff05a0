"""instrument against its twin: the stream of the network, and the profile beside it.

Sweeps: all recorded frames, corner frames, frames that drive every hidden sum to its ends, and
random ones; recorded and random ones for the profile.
Drives: frames as close as the network takes them, with gaps, of wrong lengths, with resets; for the
profile at all distances, so that many results come while a ramp is being drawn.
Checks: outputs, ``frame_error`` and every point of the profile bit for bit in their clocks.
Does not prove: the profile's extremes (tb_load_profile drives the block by itself).
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.network import (
    corners_and_random,
    random_elements,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    whole_frames,
    wrong_lengths,
)
from tb.common.profile import check_profile
from tb.common.stimulus import random_resets, spread

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]

WATCH = ["out_valid", "out_data", "out_last"]
PROFILE = ["profile_valid", "profile_x", "profile_y", "profile_last"]


async def check(bench, frames, resets=None):
    twin = bench.twin
    latency = bench.latency_of(twin.load_profile.entity)
    ramp = twin.load_profile.ramp.points * latency
    elements, last = whole_frames(bench, frames)
    length = len(elements) // len(frames)
    pause = np.zeros((len(frames), length), dtype=np.int64)
    # Many come during a ramp, others when the instrument is at rest.
    pause[:, 0] = bench.rng.integers(twin.interval, ramp * 4 // 3, len(frames))
    items = {"in_data": elements, "in_last": last}
    tail = bench.latency + 2 * ramp + twin.outputs + 8
    drive = spread(bench.rng, items, "in_valid", 0.0, tail=tail, pause=pause.ravel())
    if resets:
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), resets)
    recording = await bench.play(drive, WATCH + PROFILE)
    # The network's own results, which the other tests compare, are what is drawn.
    ends = recording.rows("out_last")
    codes = recording.signed("out_data", recording.rows("out_valid"))
    at = np.searchsorted(recording.rows("out_valid"), ends)
    results = codes[at[:, np.newaxis] + np.arange(1 - twin.outputs, 1)]
    kept = recording.undisturbed(ends, ends)
    return check_profile(
        bench, recording, "profile", ends[kept] + 1, results[kept], latency, twin.profile
    )


@cocotb.test()
async def profiles(dut):
    bench = Bench(dut)
    random = random_elements(bench, 16 * bench.twin.inputs).reshape(16, -1)
    frames = np.concatenate([bench.scene.vectors().codes[:16], random])
    drawn = await check(bench, frames)
    assert len(set(drawn)) < len(frames), "no results came during a ramp"
    bench.finish(at_least=8 * bench.twin.load_profile.ramp.points)


@cocotb.test()
async def profiles_and_resets(dut):
    bench = Bench(dut)
    frames = random_elements(bench, 24 * bench.twin.inputs).reshape(24, -1)
    await check(bench, frames, resets=1000)
    bench.finish(at_least=5 * bench.twin.load_profile.ramp.points)
