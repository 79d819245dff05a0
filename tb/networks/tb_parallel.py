"""parallel, every multiplication at once, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); frames that drive each hidden sum to both of its ends; 400 random frames.
Drives: frames as close as the design takes them, with random gaps, closer than it takes them, with
resets among them, and with one reset at each clock of a frame's way through the design.
Checks: every output and ``frame_error`` bit for bit in its clock, and that no output comes in any
other clock. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

import cocotb
import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench
from tb.common.case_library import PARALLEL
from tb.common.framing import scan
from tb.common.stimulus import corner_frames, extreme_frames, random_resets, spread

CASES = PARALLEL


def ports(name, count):
    return [f"{name}_{i}" for i in range(count)]


async def check(bench, frames, gap, pause, resets=None):
    """Play frames, and compare with what the twin computes from the recorded frames.

    ``resets`` gives the reset column for a number of clocks.
    """
    twin, latency = bench.twin, bench.latency
    sensors, outputs = ports("in_data", twin.inputs), ports("out_data", twin.outputs)
    items = dict(zip(sensors, frames.T, strict=True))
    drive = spread(bench.rng, items, "in_valid", gap, tail=latency + 4, pause=pause)
    if resets is not None:
        drive["rst"] = resets(len(drive["in_valid"]))
    recording = await bench.play(drive, ["out_valid", *outputs, "frame_error"])

    # The element that holds a frame is also the last of the frame.
    rows, judged = scan(twin.input_controller, recording, last="in_valid")
    entered = rows[judged.done]
    seen = np.stack([recording.signed(port, entered) for port in sensors], axis=-1)
    alive = recording.undisturbed(entered, entered + latency - 1)
    left = recording.rows("out_valid")
    bench.compare("clocks of out_valid", left, entered[alive] + latency)
    got = np.stack([recording.signed(port, left) for port in outputs], axis=-1)
    bench.compare("out_data", got, twin.process(seen[alive]), frame=seen[alive])
    errors = recording.rows("frame_error")
    bench.compare("clocks of frame_error", errors, rows[judged.error] + 1)
    return recording, entered, errors


def random_frames(bench, count):
    return bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (count, bench.twin.inputs))


@cocotb.test()
async def recorded(dut):
    """Play all recorded frames, closest first, then with gaps, and count the clocks of a frame."""
    bench = Bench(dut)
    codes = bench.given.codes
    pause = bench.twin.interval - 1
    recording, entered, _ = await check(bench, codes, gap=0.0, pause=pause)
    assert len(entered) == len(codes), "a recorded frame was refused"
    bench.facts = {
        "frames": len(codes),
        "seconds": recording.seconds,
        "clocks_per_frame": int(recording.rows("out_valid")[0] - entered[0] + 1),
        "interval": int(np.diff(entered).min()),
    }
    await check(bench, codes, gap=0.3, pause=pause)
    bench.finish(at_least=len(codes))


@cocotb.test()
async def corners_and_random(dut):
    """Play corner frames, frames that drive hidden sums to their ends, and random frames."""
    bench = Bench(dut)
    ends = extreme_frames(SIGNAL, [neuron.weights for neuron in bench.twin.hidden_neurons])
    corners = corner_frames(SIGNAL, bench.twin.inputs)
    frames = np.concatenate([corners, ends, random_frames(bench, 400)])
    for gap in (0.0, 0.4):
        await check(bench, frames, gap, pause=bench.twin.interval - 1)
    bench.finish(at_least=400)


@cocotb.test()
async def too_close(dut):
    """Play frames closer than the design takes them, if it does not take one every clock."""
    bench = Bench(dut)
    pause = bench.rng.integers(0, bench.twin.interval + 1, 400)
    _, _, errors = await check(bench, random_frames(bench, 400), gap=0.0, pause=pause)
    assert bool(len(errors)) == (bench.twin.interval > 1), "frame_error is wrong throughout"
    bench.finish(at_least=20)


@cocotb.test()
async def resets_among_frames(dut):
    """Play frames at any distance, with resets at random clocks."""
    bench = Bench(dut)
    pause = bench.rng.integers(0, bench.twin.interval + 1, 600)
    every = 2 * (bench.twin.interval + bench.latency)
    await check(
        bench,
        random_frames(bench, 600),
        gap=0.2,
        pause=pause,
        resets=lambda length: random_resets(bench.rng, length, every),
    )
    bench.finish(at_least=20)


@cocotb.test()
async def reset_at_every_clock(dut):
    """Play a frame, a reset so many clocks after it, and then a good frame."""
    bench = Bench(dut)
    span = max(bench.latency + 2, bench.twin.interval)

    def resets(clocks):
        column = np.zeros(clocks, dtype=np.int64)
        for t in range(span):
            # Frame 2 t enters in this clock, and frame 2 t + 1 a span and one clock later.
            column[2 * t * (span + 1) + span + t] = 1
        return column

    _, entered, _ = await check(
        bench, random_frames(bench, 2 * span), gap=0.0, pause=span, resets=resets
    )
    assert len(entered) == 2 * span - 1, "a frame after a reset was refused"
    bench.finish(at_least=span)
