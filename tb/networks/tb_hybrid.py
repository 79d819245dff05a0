"""hybrid, the whole folded network, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one
sensor alone); frames that drive each hidden sum to its ends; 400 random frames; frames too short
and too long among good ones.
Drives: as close as the design takes frames, with random gaps, closer than it takes them, and with
resets in mid-frame.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that nothing
comes out in any other clock. Measures the clocks of a frame.
Does not prove: anything about the accuracy of the network (the report of `make demo` does).
"""

import cocotb
import numpy as np

from golden.fixed import Fix
from tb.common.bench import Bench
from tb.common.framing import random_lengths, scan
from tb.common.stimulus import corner_frames, extreme_frames, random_resets, spread

WATCH = ["out_valid", "out_data", "out_last", "frame_error"]


async def check(bench, samples, last, gap, resets=False, pause=0):
    """Play a sample stream; expect what the twin makes of the stream that was recorded."""
    twin = bench.twin
    outputs, latency = twin.outputs, bench.latency
    items = {"in_data": samples, "in_last": last}
    drive = spread(bench.rng, items, "in_valid", gap, tail=latency + outputs + 4, pause=pause)
    if resets:
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), every=60)
    recording = await bench.play(drive, WATCH)

    rows, frames = scan(twin.input_controller, recording)
    done = np.flatnonzero(frames.done)
    data = recording.signed("in_data", rows)
    seen = data[done[:, np.newaxis] + np.arange(1 - twin.inputs, 1)]
    results = twin.process(seen)
    at = rows[done][:, np.newaxis] + latency + np.arange(outputs)
    alive = recording.undisturbed(np.repeat(rows[done], outputs), (at - 1).ravel())
    expected_rows = at.ravel()[alive]

    left = recording.rows("out_valid")
    bench.compare("clocks of out_valid", left, expected_rows)
    frame = np.repeat(seen, outputs, axis=0)[alive]
    got = recording.signed("out_data", left)
    bench.compare("out_data", got, results.ravel()[alive], frame=frame)
    last_rows = expected_rows[np.tile(np.arange(outputs) == outputs - 1, len(done))[alive]]
    bench.compare("clocks of out_last", recording.rows("out_last"), last_rows)
    bench.compare("clocks of frame_error", recording.rows("frame_error"), rows[frames.error] + 1)
    return recording, rows, frames


def whole_frames(frames):
    """The sample stream of good frames."""
    last = np.zeros(frames.shape, dtype=np.int64)
    last[:, -1] = 1
    return frames.ravel(), last.ravel()


def pauses(bench, last, closest=False):
    """Idle clocks before each sample, so that frames are as close as the design takes them, or
    at random as close or closer.
    """
    twin = bench.twin
    most = twin.interval - twin.inputs
    first = np.roll(last, 1)
    return first * (most if closest else bench.rng.integers(0, most + 1, len(last)))


def random_samples(bench, count):
    fmt: Fix = bench.twin.input_integral.nodes[0].in_fmt
    return bench.rng.integers(fmt.low, fmt.high + 1, count)


@cocotb.test()
async def recorded(dut):
    bench = Bench(dut)
    codes = bench.scene.vectors().codes
    outputs = bench.twin.outputs
    samples, last = whole_frames(codes)
    pause = pauses(bench, last, closest=True)
    recording, rows, frames = await check(bench, samples, last, gap=0.0, pause=pause)
    entered = rows[frames.done]
    assert len(entered) == len(codes), "a recorded frame was refused"
    first = entered[0] - bench.twin.inputs + 1
    final = recording.rows("out_last")[0]
    bench.facts = {
        "frames": len(codes),
        "seconds": recording.seconds,
        "clocks_per_frame": int(final - first + 1),
        "interval": int(np.diff(entered).min()),
    }
    await check(bench, samples, last, gap=0.3, pause=pause)
    bench.finish(at_least=len(codes) * outputs)


@cocotb.test()
async def corners_and_random(dut):
    bench = Bench(dut)
    fmt = bench.twin.input_integral.nodes[0].in_fmt
    random = random_samples(bench, 400 * bench.twin.inputs).reshape(400, -1)
    ends = extreme_frames(fmt, [node.weights for node in bench.twin.input_integral.nodes])
    frames = np.concatenate([corner_frames(fmt, bench.twin.inputs), ends, random])
    samples, last = whole_frames(frames)
    for gap in (0.0, 0.4):
        pause = pauses(bench, last, closest=True)
        await check(bench, samples, last, gap=gap, pause=pause)
    bench.finish(at_least=400)


@cocotb.test()
async def wrong_lengths(dut):
    bench = Bench(dut)
    for gap in (0.0, 0.4):
        last = random_lengths(bench.rng, bench.twin.inputs, 1500)
        samples, pause = random_samples(bench, len(last)), pauses(bench, last)
        _, _, frames = await check(bench, samples, last, gap, pause=pause)
        assert frames.error.any(), "no wrong frame was driven"
    bench.finish(at_least=200)


@cocotb.test()
async def resets_in_mid_frame(dut):
    bench = Bench(dut)
    last = random_lengths(bench.rng, bench.twin.inputs, 2500)
    samples, pause = random_samples(bench, len(last)), pauses(bench, last)
    await check(bench, samples, last, gap=0.2, resets=True, pause=pause)
    bench.finish(at_least=200)
