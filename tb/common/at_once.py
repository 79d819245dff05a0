"""The tests of networks that take a whole frame in a clock."""

import numpy as np

from golden.networks.oracle import hidden_weights
from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench, test_named
from tb.common.framing import scan
from tb.common.readout import WINNER
from tb.common.stimulus import corner_frames, extreme_frames, random_resets, spread


def ports(name, count):
    return [f"{name}_{i}" for i in range(count)]


def winner_of(twin):
    """The block that finds the largest output, if the design has one."""
    return getattr(twin, "argmax", None)


def through(twin):
    """Clocks from a frame to the last that it gives."""
    argmax = winner_of(twin)
    return twin.latency + (argmax.latency if argmax else 0)


async def check(bench, frames, gap, pause=None, resets=None):
    """Play frames, and compare with what the twin computes from the recorded frames.

    pause: Idle clocks before each frame; by default frames are as close as the design takes them.
    resets: Gives the reset column for a number of clocks.
    """
    twin, latency, argmax = bench.twin, bench.latency, winner_of(bench.twin)
    sensors, outputs = ports("in_data", twin.inputs), ports("out_data", twin.outputs)
    items = dict(zip(sensors, frames.T, strict=True))
    pause = twin.interval - 1 if pause is None else pause
    drive = spread(bench.rng, items, "in_valid", gap, tail=through(twin) + 4, pause=pause)
    if resets is not None:
        drive["rst"] = resets(len(drive["in_valid"]))
    winner = WINNER if argmax else []
    recording = await bench.play(drive, ["out_valid", *outputs, *winner, "frame_error"])

    # The element that holds a frame is also the last of the frame.
    rows, judged = scan(twin.input_controller, recording, last="in_valid")
    entered = rows[judged.done]
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
    bench.compare("clocks of frame_error", recording.rows("frame_error"), rows[judged.error] + 1)
    return recording, entered


def random_frames(bench, count):
    return bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (count, bench.twin.inputs))


def suite(module: str, close: bool = False):
    """The tests of a network, in the order in which they stand here.

    module: The name of the bench.
    close: Whether frames may come closer than the design takes them, which must vanish.
    """

    @test_named(module, "recorded")
    async def recorded(dut):
        """Play all recorded frames, closest first, then with gaps; count the clocks of a frame."""
        bench = Bench(dut)
        codes = bench.given.codes
        recording, entered = await check(bench, codes, gap=0.0)
        assert len(entered) == len(codes), "a recorded frame was refused"
        final = recording.rows("out_valid")[0]
        bench.measured(recording, len(codes), entered[0], final, entered)
        await check(bench, codes, gap=0.3)
        bench.finish(at_least=len(codes))

    @test_named(module, "corners_and_random")
    async def corners_and_random(dut):
        """Play corner frames, frames that drive hidden sums to their ends, and random frames."""
        bench = Bench(dut)
        ends = extreme_frames(SIGNAL, hidden_weights(bench.twin))
        corners = corner_frames(SIGNAL, bench.twin.inputs)
        frames = np.concatenate([corners, ends, random_frames(bench, 400)])
        for gap in (0.0, 0.4):
            await check(bench, frames, gap)
        bench.finish(at_least=400)

    @test_named(module, "reset_at_every_clock")
    async def reset_at_every_clock(dut):
        """Play a frame, a reset so many clocks after it, and then a good frame."""
        bench = Bench(dut)
        span = max(through(bench.twin) + 2, bench.twin.interval)

        def resets(clocks):
            column = np.zeros(clocks, dtype=np.int64)
            for t in range(span):
                # Frame 2 t enters in this clock, and frame 2 t + 1 a span and one clock later.
                column[2 * t * (span + 1) + span + t] = 1
            return column

        _, entered = await check(bench, random_frames(bench, 2 * span), 0.0, span, resets)
        assert len(entered) == 2 * span - 1, "a frame after a reset was lost"
        bench.finish(at_least=span)

    @test_named(module, "resets_among_frames")
    async def resets_among_frames(dut):
        """Play frames at any distance, with resets at random clocks."""
        bench = Bench(dut)
        pause = bench.rng.integers(0, bench.twin.interval + 1, 600) if close else 0
        every = 2 * (bench.twin.interval + through(bench.twin))

        def resets(length):
            return random_resets(bench.rng, length, every)

        await check(bench, random_frames(bench, 600), 0.2, pause, resets)
        bench.finish(at_least=20)

    return recorded, corners_and_random, reset_at_every_clock, resets_among_frames
