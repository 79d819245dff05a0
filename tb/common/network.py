"""The tests that every network must pass, whatever its arrangement. Its bench imports them.

A frame of the stream is as long as the twin's controller says. It holds the samples and, in a
cascade, slots whose contents have no effect, so they are driven at random.
"""

import cocotb
import numpy as np

from golden.common.block import walk
from golden.networks.oracle import designs_in, hidden_weights
from golden.networks.windowed import Windowed
from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench
from tb.common.framing import check_outputs, random_lengths, scan, whole
from tb.common.loading import after_loading, untaught
from tb.common.stimulus import corner_frames, extreme_frames, random_resets, spread, with_past

WATCH = ["out_valid", "out_data", "out_last", "frame_error"]
# About how many clocks a test plays. A design that takes many clocks for a frame gets fewer frames.
MOST_CLOCKS = 100_000
# The same for recorded frames, unless more frames are asked for.
MOST_RECORDED = 250_000
# Up to so many clocks, more random frames are played than asked for, because a hidden sum is seldom
# small enough for its least bit to have an effect.
MORE_CLOCKS = 5_000
# How many random and how many recorded frames are played with gaps as well.
MOST_WITH_GAPS = 100
MOST_RECORDED_WITH_GAPS = 200
# How many bytes of images are loaded between resets in all.
MOST_LOADED = 100_000


async def check(bench, elements, last, gap, resets=None, pause=0):
    """Play a stream, and compare with what the twin computes from the recorded stream.

    ``resets`` gives the reset column for a number of clocks.
    """
    twin = bench.twin
    length = twin.input_controller.inputs
    items = {"in_data": elements, "in_last": last}
    tail = twin.output_clocks[-1] + 5
    drive = spread(bench.rng, items, "in_valid", gap, tail=tail, pause=pause)
    if resets is not None:
        drive["rst"] = resets(len(drive["in_valid"]))
    drive = untaught(bench, drive)
    if twin.image:
        drive = after_loading(drive, twin.image)
    recording = await bench.play(drive, WATCH)

    rows, frames = scan(twin.input_controller, recording)
    done = np.flatnonzero(frames.done)
    data = recording.signed("in_data", rows)
    seen = data[done[:, np.newaxis] + np.arange(1 - length, 1)]
    run = twin, rows[done - length + 1], rows[done], seen[:, : twin.inputs]
    check_outputs(bench, recording, run)
    bench.compare("clocks of frame_error", recording.rows("frame_error"), rows[frames.error] + 1)
    return recording, rows, frames


def whole_frames(bench, frames):
    """The elements and ``last`` flags of a stream of good frames."""
    slots = bench.twin.input_controller.inputs - frames.shape[1]
    filling = bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (len(frames), slots))
    return whole(np.concatenate([frames, filling], axis=1))


def pauses(bench, last, closest=False):
    """Idle clocks before each element.

    With ``closest`` the frames are as close as the design takes them. Otherwise each is, at random,
    as close or closer.
    """
    most = bench.twin.interval - bench.twin.input_controller.inputs
    first = np.roll(last, 1)
    return first * (most if closest else bench.rng.integers(0, most + 1, len(last)))


def recorded_frames(bench):
    """The recorded frames, or as many as there are clocks for or as FRAMES= asks for.

    For a network inside a frame window they are the frames that the window sends to it.
    """
    given, past = bench.given, bench.twin.past
    frames = np.concatenate(given.recordings) if past else given.codes
    return frames[: past + max(bench.frames, MOST_RECORDED // bench.twin.interval)]


def random_elements(bench, count):
    return bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, count)


def affordable(bench, frames):
    """How many of ``frames`` frames fit into a quarter of the clocks, and their past."""
    most = max(20, MOST_CLOCKS // 4 // bench.twin.interval)
    return bench.twin.past + min(frames, most)


def frames_of_all_lengths(bench, samples):
    """The ``last`` flags of so many samples, or of as many as there are clocks for.

    Half of the frames may be refused, and some come between resets, so more past frames are added.
    """
    length = bench.twin.input_controller.inputs
    most = min(samples, length * affordable(bench, samples))
    return random_lengths(bench.rng, length, most + 8 * length * bench.twin.past)


def driven_to_ends(bench):
    """Frames that drive every sum of samples to both of its ends."""
    inputs = bench.twin.core.inputs
    rows = [row[:inputs] for design in designs_in(bench.twin) for row in hidden_weights(design)]
    ends = extreme_frames(SIGNAL, rows)
    for part in walk(bench.twin):
        if isinstance(part, Windowed):
            most = affordable(bench, len(ends) * (part.past + 1)) // (part.past + 1)
            some = ends if len(ends) <= most else bench.rng.choice(ends, most, replace=False)
            return with_past(part.window, some, bench.rng)
    return ends


@cocotb.test()
async def recorded(dut):
    """Play all recorded frames as close as the design takes them, then the first with gaps."""
    bench = Bench(dut)
    codes, past = recorded_frames(bench), bench.twin.past
    elements, last = whole_frames(bench, codes)
    pause = pauses(bench, last, closest=True)
    recording, rows, frames = await check(bench, elements, last, gap=0.0, pause=pause)
    entered = rows[frames.done]
    assert len(entered) == len(codes), "a recorded frame was refused"
    first = entered[past] - bench.twin.input_controller.inputs + 1
    final = recording.rows("out_last")[0]
    bench.measured(recording, len(codes), first, final, entered)
    most = affordable(bench, MOST_RECORDED_WITH_GAPS)
    some = most * bench.twin.input_controller.inputs
    await check(bench, elements[:some], last[:some], gap=0.3, pause=pause[:some])
    bench.finish(at_least=(len(codes) - past) * bench.twin.outputs)


@cocotb.test()
async def corners_and_random(dut):
    """Play corner frames, frames that drive hidden sums to their ends, and random frames."""
    bench = Bench(dut)
    inputs = bench.twin.inputs
    most = affordable(bench, bench.frames)
    many = max(most, MORE_CLOCKS // bench.twin.interval)
    random = random_elements(bench, many * inputs).reshape(-1, inputs)
    fixed = np.concatenate([corner_frames(SIGNAL, inputs), driven_to_ends(bench)])
    # In a long frame every gap costs many clocks, so fewer of these frames are played with gaps.
    some = fixed[:: -(-len(fixed) * bench.twin.interval // MOST_CLOCKS)]
    for gap, chosen, count in ((0.0, fixed, many), (0.4, some, min(most, MOST_WITH_GAPS))):
        frames = np.concatenate([chosen, random[:count]])
        elements, last = whole_frames(bench, frames)
        await check(bench, elements, last, gap, pause=pauses(bench, last, closest=True))
    bench.finish(at_least=most)


@cocotb.test()
async def wrong_lengths(dut):
    """Play frames that are too short or too long among good frames."""
    bench = Bench(dut)
    for gap in (0.0, 0.4):
        last = frames_of_all_lengths(bench, 500)
        elements = random_elements(bench, len(last))
        _, _, frames = await check(bench, elements, last, gap, pause=pauses(bench, last))
        assert frames.error.any(), "no wrong frame was driven"
    bench.finish(at_least=20)


@cocotb.test()
async def resets_in_mid_frame(dut):
    """Play frames of all lengths with resets at random clocks."""
    bench = Bench(dut)
    last = frames_of_all_lengths(bench, 800)
    # The past needs twice as many frames, because half of them may be refused.
    past = 2 * bench.twin.past * bench.twin.interval
    every = 2 * (bench.twin.input_controller.inputs + bench.twin.output_clocks[-1] + past)
    await check(
        bench,
        random_elements(bench, len(last)),
        last,
        gap=0.2,
        resets=lambda length: random_resets(bench.rng, length, every),
        pause=pauses(bench, last),
    )
    bench.finish(at_least=10)


@cocotb.test()
async def reset_at_every_clock(dut):
    """Play a frame, a reset so many clocks after its first element, and then a good frame.

    This is done for each clock of a frame. In a long frame the resets are at its beginning, at its
    end, and at random between them. With past frames there are a quarter as many resets, and each
    of the two frames follows those that it needs as its past. If an image must be loaded after each
    reset, there are fewer, as the test would take minutes.
    """
    bench = Bench(dut)
    twin = bench.twin
    inputs, length = twin.inputs, twin.input_controller.inputs
    span = length + twin.output_clocks[-1] + 3
    before = twin.past * twin.interval
    most = min(span, max(3, MOST_CLOCKS // (2 * (span + before))))
    if twin.past:
        # The bench of frame_window has a reset at every clock of the frames before the network.
        most = max(3, most // 4)
    if twin.image:
        most = max(3, min(most, MOST_LOADED // len(twin.image)))
    ends = most // 3
    between = np.arange(ends, span - ends)
    some = bench.rng.permutation(between)[: most - 2 * ends]
    at = [*range(ends), *np.sort(some), *range(span - ends, span)]
    count = twin.past + 1
    frames = random_elements(bench, 2 * len(at) * count * inputs).reshape(-1, inputs)
    apart = max(span, twin.interval)
    pause = np.zeros((2 * len(at), count, length), dtype=np.int64)
    pause[:, :, 0] = twin.interval - length
    pause[:, 0, 0] = apart

    def resets(clocks):
        column = np.zeros(clocks, dtype=np.int64)
        for k, t in enumerate(at):
            # The reset falls on frame 2 k, with its past before it; frame 2 k + 1 is the good
            # frame.
            column[2 * k * (apart + length + before) + apart + before + t] = 1
        return column

    _, _, scanned = await check(
        bench, *whole_frames(bench, frames), gap=0.0, resets=resets, pause=pause.ravel()
    )
    assert scanned.done.sum() >= len(at) * count, "a frame after a reset was refused"
    bench.finish(at_least=len(at) * twin.outputs)


TESTS = recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock
