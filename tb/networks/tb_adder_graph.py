"""adder_graph, every sum a graph of shifted adds, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); frames that drive each hidden sum to both of its ends; 400 random frames.
Drives: frames in every clock, with random gaps, with resets among them, and with one reset at each
clock of a frame's way through the design.
Checks: every output bit for bit in its clock, that no output comes in any other clock, the same of
index and margin of the largest output where the design has them, and that ``frame_error`` stays
low. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

import cocotb
import numpy as np

from golden.networks.oracle import hidden_weights
from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench
from tb.common.case_library import ADDER_GRAPHS
from tb.common.readout import WINNER
from tb.common.stimulus import corner_frames, extreme_frames, random_resets, spread

CASES = ADDER_GRAPHS


def through(twin):
    """Clocks from a frame to the last that it gives."""
    return twin.latency + (twin.argmax.latency if twin.argmax else 0)


def ports(name, count):
    return [f"{name}_{i}" for i in range(count)]


async def check(bench, frames, gap, pause=0, resets=None):
    """Play frames, and compare with what the twin computes from the recorded frames.

    ``resets`` gives the reset column for a number of clocks.
    """
    twin, latency, argmax = bench.twin, bench.latency, bench.twin.argmax
    sensors, outputs = ports("in_data", twin.inputs), ports("out_data", twin.outputs)
    items = dict(zip(sensors, frames.T, strict=True))
    tail = through(twin) + 4
    drive = spread(bench.rng, items, "in_valid", gap, tail=tail, pause=pause)
    if resets is not None:
        drive["rst"] = resets(len(drive["in_valid"]))
    winner = WINNER if argmax else []
    recording = await bench.play(drive, ["out_valid", *outputs, *winner, "frame_error"])

    entered = recording.rows("in_valid")
    entered = entered[recording.undisturbed(entered, entered)]
    seen = np.stack([recording.signed(port, entered) for port in sensors], axis=-1)
    alive = recording.undisturbed(entered, entered + latency - 1)
    left = recording.rows("out_valid")
    bench.compare("clocks of out_valid", left, entered[alive] + latency)
    got = np.stack([recording.signed(port, left) for port in outputs], axis=-1)
    bench.compare("out_data", got, twin.process(seen[alive]), frame=seen[alive])
    if argmax:
        kept = recording.undisturbed(left, left + argmax.latency - 1)
        at = left[kept] + argmax.latency
        bench.compare("clocks of winner_valid", recording.rows("winner_valid"), at)
        for port, expected in zip(WINNER[1:], argmax.process(got[kept]), strict=True):
            bench.compare(port, recording.unsigned(port, at), expected, outputs=got[kept])
    assert not len(recording.rows("frame_error")), "frame_error is high"
    return recording, entered


def random_frames(bench, count):
    return bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (count, bench.twin.inputs))


@cocotb.test()
async def recorded(dut):
    """Play all recorded frames back to back, then with gaps, and count the clocks of a frame."""
    bench = Bench(dut)
    codes = bench.given.codes
    recording, entered = await check(bench, codes, gap=0.0)
    bench.facts = {
        "frames": len(codes),
        "seconds": recording.seconds,
        "clocks_per_frame": int(recording.rows("out_valid")[0] - entered[0] + 1),
        "interval": int(np.diff(entered).min()) if len(entered) > 1 else 1,
    }
    await check(bench, codes, gap=0.3)
    bench.finish(at_least=len(codes))


@cocotb.test()
async def corners_and_random(dut):
    """Play corner frames, frames that drive hidden sums to their ends, and random frames."""
    bench = Bench(dut)
    ends = extreme_frames(SIGNAL, hidden_weights(bench.twin))
    corners = corner_frames(SIGNAL, bench.twin.inputs)
    frames = np.concatenate([corners, ends, random_frames(bench, 400)])
    for gap in (0.0, 0.4):
        await check(bench, frames, gap)
    bench.finish(at_least=400)


@cocotb.test()
async def resets_among_frames(dut):
    """Play frames at any distance, with resets at random clocks."""
    bench = Bench(dut)
    every = 2 * (1 + through(bench.twin))
    await check(
        bench,
        random_frames(bench, 600),
        gap=0.2,
        resets=lambda length: random_resets(bench.rng, length, every),
    )
    bench.finish(at_least=20)


@cocotb.test()
async def reset_at_every_clock(dut):
    """Play a frame, a reset so many clocks after it, and then a good frame."""
    bench = Bench(dut)
    span = through(bench.twin) + 2

    def resets(clocks):
        column = np.zeros(clocks, dtype=np.int64)
        for t in range(span):
            # Frame 2 t enters in this clock, and frame 2 t + 1 a span and one clock later.
            column[2 * t * (span + 1) + span + t] = 1
        return column

    _, entered = await check(
        bench, random_frames(bench, 2 * span), gap=0.0, pause=span, resets=resets
    )
    assert len(entered) == 2 * span - 1, "a frame after a reset was lost"
    bench.finish(at_least=span)
