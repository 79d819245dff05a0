"""input_controller against its twin: frames of all lengths with gaps and resets."""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.framing import random_lengths, scan
from tb.common.properties import Property
from tb.common.recorded_frames import recorded_frames
from tb.common.stimulus import random_resets, spread
from tb.common.watch import ago, frames

CASES = cases("rails", "least", "wide")
# A case in which the least distance of frames is more than their length.
PROVED = ("drawn",)

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


def properties(twin):
    late, spacing = twin.latency, twin.spacing
    least = f" or that ends less than {spacing} clocks after a good one" if spacing else ""
    return [
        Property(
            name="good frames only",
            sentence=f"frame_error is high for exactly one clock for each frame that does not have "
            f"{twin.inputs} samples{least}. It comes one clock after the sample that shows this. "
            f"capture is high 3 clocks, and out_valid {late} clocks, after the "
            "last sample of a good frame, unless a reset came between. They are high in no other "
            "clock. For each sample of a frame that is not yet known to be wrong, addr is its "
            "position, and it is added two clocks later. preset comes only with the first sample "
            "of a frame.",
            states=(
                "frame_error == wrong_ago[0]",
                "capture == good_ago[2]",
                f"out_valid == good_ago[{late - 1}]",
                "!taken || addr == place",
                "accumulate == taken_ago[1]",
                "preset == first_ago[1]",
            ),
            watch=frames(twin.inputs, spacing)
            + ago("wrong_ago", "wrong", 1)
            + ago("good_ago", "good", late)
            + ago("taken_ago", "taken", 2)
            + ago("first_ago", "taken && place == 0", 2),
            helps=(
                "place == count",
                "skipping == dropping",
                f"place < {twin.inputs}",
                "!skipping || place == 0",
                "closed == remaining" if spacing else "closed == 0",
            ),
            reached=(
                *("frame_error", "skipping && in_valid", "out_valid"),
                *("preset", "accumulate && !preset"),
            ),
            refuted_by=(
                (r"&& \(!done\)", "&& (!in_last)"),
                (r"in_valid && \(!dropping\)", "in_valid"),
                (r"dropping <= \(!in_last\)", "dropping <= 0"),
                (r"accept && complete && in_last", "accept && complete"),
                (r"delay3_taps\[0\] <= done", "delay3_taps[0] <= complete"),
                (r"rst == 1", "0"),
                (r"accept && \(count == 0\)", "accept"),
                (r"count <= \(count \+ 1\)", "count <= count"),
            ),
            induction=late + 2,
        )
    ]
