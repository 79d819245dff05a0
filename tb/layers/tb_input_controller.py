"""input_controller against its twin.

Sweeps: 4000 samples in frames of the right length, shorter and longer ones, mixed at random.
Drives: the samples back to back and with gaps; then the same with resets at random clocks; then the
recorded frames as close as the design takes them.
Checks: that address, accumulate, preset, capture, valid and frame_error come in their clocks, and
that none of the flags is high in any other clock.
Does not prove: what frames longer than three times the right length do.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import FOLDED
from tb.common.framing import random_lengths, scan
from tb.common.recorded_frames import recorded_frames
from tb.common.stimulus import random_resets, spread

CASES = {name: FOLDED[name] for name in ("rails", "least", "wide")}

RECORDED = 1000
OUTPUTS = ["addr", "preset", "accumulate", "capture", "out_valid", "frame_error"]


async def check(bench, gap, resets):
    last = random_lengths(bench.rng, bench.twin.inputs, 4000)
    drive = spread(bench.rng, {"in_last": last}, "in_valid", gap, tail=6)
    if resets:
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), every=50)
    frames = await check_frames(bench, drive)
    assert np.any(frames.error), "no wrong frame was driven"
    assert np.any(frames.done), "no good frame was driven"
    bench.finish(at_least=2000)


async def check_frames(bench, drive):
    """Play samples, compare every output, and return the decisions of the twin."""
    recording = await bench.play(drive, OUTPUTS)
    rows, frames = scan(bench.twin, recording)
    accepted = rows[frames.accept]
    position, dropping = (state.name for state in bench.twin.states)
    bench.visit(position, frames.addr[frames.accept])
    bench.visit(dropping, ~frames.accept)
    # From a good frame to the end of the next complete frame, without a reset between them.
    whole = rows[(frames.addr == bench.twin.inputs - 1) & np.isin(rows, recording.rows("in_last"))]
    good = rows[frames.done]
    before = np.append(0, good)[np.searchsorted(good, whole)]
    alive = (before > 0) & recording.undisturbed(before, whole)
    bench.meet("clocks from frame to frame", (whole - before)[alive])
    opening = rows[frames.accept & (frames.addr == 0)]
    done = rows[frames.done]
    addr = recording.unsigned("addr", accepted)
    bench.compare("addr", addr, frames.addr[frames.accept], clock=accepted)
    # A reset in row t clears the flags that would rise in row t + 1 or later.
    for port, cause, delay in [
        ("accumulate", accepted, 2),
        ("preset", opening, 2),
        ("capture", done, 3),
        ("out_valid", done, 4),
        ("frame_error", rows[frames.error], 1),
    ]:
        alive = cause[recording.undisturbed(cause, cause + delay - 1)]
        bench.compare(f"clocks of {port}", recording.rows(port), alive + delay)
    return frames


@cocotb.test()
async def back_to_back(dut):
    await check(Bench(dut), gap=0.0, resets=False)


@cocotb.test()
async def recorded(dut):
    """Play the recorded frames as close as the design takes them."""
    bench = Bench(dut)
    inputs, count = bench.twin.inputs, len(recorded_frames(bench, most=RECORDED))
    place = np.tile(np.arange(inputs), count)
    pause = (place == 0) * (bench.given.design.core.interval - inputs)
    last = (place == inputs - 1).astype(np.int64)
    drive = spread(bench.rng, {"in_last": last}, "in_valid", gap=0.0, tail=6, pause=pause)
    frames = await check_frames(bench, drive)
    bench.facts["recorded"] = int(frames.done.sum())
    assert frames.done.sum() == count, "a recorded frame was refused"
    # The address of each sample and the flags of each frame are compared.
    bench.finish(at_least=count * (inputs + 2))


@cocotb.test()
async def gaps(dut):
    await check(Bench(dut), gap=0.5, resets=False)


@cocotb.test()
async def resets(dut):
    await check(Bench(dut), gap=0.2, resets=True)
