"""frame_check against its twin.

Sweeps: 1000 samples in frames of the right length, shorter and longer ones, mixed at random.
Drives: frames that are far enough apart, frames that come before the last one is computed, frames
in each clock around the first that is late enough, frames with gaps, and frames with resets at
random clocks. After each good frame ``finish`` comes when the engine would give it; ``store`` is
high at random while a frame is computed, where results are counted.
Checks: that start, run, write with its address, and frame_error come in their clocks, and that no
flag is high in any other clock.
Does not prove: that a finish while no frame is computed does no harm; the program rules it out.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.case_library import ENGINES, LESSONS
from tb.common.framing import random_lengths, scan
from tb.common.stimulus import random_resets, spread

CASES = {name: ENGINES[name] for name in ("rails-engine", "least-engine", "deep-least-engine")}
# This counts samples alone.
CASES |= {"lesson": LESSONS["lesson"]}

SAMPLES = 1000
# By how many clocks a frame comes later than the last clock that is too early.
ABOUT = range(-2, 3)


def computed(twin, drive):
    """The clocks of ``finish``, and those in which a frame is computed.

    As in the engine, ``finish`` comes ``busy`` clocks after a good frame.
    """
    length = len(drive["in_valid"])
    flags, running = np.zeros(length, dtype=np.int64), np.zeros(length, dtype=bool)
    resets = np.flatnonzero(drive["rst"])
    rows = np.setdiff1d(np.flatnonzero(drive["in_valid"]), resets)
    since = np.searchsorted(resets, rows)
    for epoch in np.unique(since):
        inside = rows[since == epoch]
        good = inside[twin.process(drive["in_last"][inside], inside).done]
        until = resets[epoch] if epoch < len(resets) else length
        ends = good + twin.busy
        flags[ends[ends < until]] = 1
        for begin, end in zip(good + twin.pipeline.run, ends, strict=True):
            running[begin : min(end + 1, until)] = True
    return flags, running


def openings(rows, last, done):
    """The clocks of the last sample of each good frame, and of the first sample after it."""
    ends = rows[done]
    opening = rows[1:][last[:-1]]
    good = np.append(-1, ends)[np.searchsorted(ends, opening)]
    return good[good >= 0], opening[good >= 0]


def timeline(bench, gap, apart, resets):
    """Frames and their clocks, with at most ``apart`` idle clocks before each frame."""
    twin, rng = bench.twin, bench.rng
    last = random_lengths(rng, twin.inputs, SAMPLES)
    (border,) = twin.borders
    # One of four frames comes about as early as is allowed.
    about = border.at - 1 + rng.integers(-2, 3, len(last))
    idle = np.where(rng.random(len(last)) < 1 / 4, about, rng.integers(0, apart + 1, len(last)))
    # Good frames at the beginning come so early too, so that each such distance occurs, however
    # long frames are.
    # A frame that comes too early is refused, so the next frame does not follow a good one.
    good = np.tile(np.arange(twin.inputs) == twin.inputs - 1, 2 * len(ABOUT)).astype(np.int64)
    last = np.concatenate([good, last])
    first = np.zeros((2 * len(ABOUT), twin.inputs), dtype=np.int64)
    first[0::2, 0], first[1::2, 0] = 2 * border.at, border.at - 1 + np.array(ABOUT)
    pause = np.concatenate([first.ravel(), np.roll(last, 1)[len(good) :] * idle])
    drive = spread(rng, {"in_last": last}, "in_valid", gap, tail=twin.busy + 6, pause=pause)
    length = len(drive["in_valid"])
    every = 3 * (twin.busy + twin.inputs)
    drive["rst"] = random_resets(rng, length, every) if resets else np.zeros(length, dtype=np.int64)
    drive["finish"], running = computed(twin, drive)
    # Some frames store a few results, others so many that the counter wraps around.
    density = np.where(np.arange(length) // (4 * twin.busy) % 2, 0.95, 1 / 3)
    if twin.results:
        drive["store"] = running & (rng.random(length) < density)
    return drive


async def check(bench, gap, apart, resets):
    twin = bench.twin
    drive = timeline(bench, gap, apart, resets)
    recording = await bench.play(drive, ["start", "run", "write", "write_addr", "frame_error"])

    rows, frames = scan(twin, recording)
    bench.visit("dropping", ~frames.accept)
    bench.visit("samples before", frames.addr[frames.accept & ~frames.error])
    ends = rows[frames.done]
    # These are the distances of samples without a reset between them.
    good, opening = openings(rows, np.isin(rows, recording.rows("in_last")), frames.done)
    near = recording.undisturbed(good, opening)
    bench.meet("clocks from a good frame to the next sample", (opening - good)[near])
    # A frame is computed until ``finish``, a reset, or the end of the recording.
    stops = np.sort(np.concatenate([recording.resets(), [recording.clocks - 1]]))
    until = np.minimum(ends + twin.busy, stops[np.searchsorted(stops, ends)])
    begin = ends + twin.pipeline.run
    # The flag is not registered, so it may be high in the clock of a reset.
    started, expected = (
        np.setdiff1d(found, recording.resets()) for found in (recording.rows("start"), begin - 1)
    )
    bench.compare("clocks of start", started, expected)
    runs = [np.arange(a, b + 1) for a, b in zip(begin, until, strict=True)]
    running = np.concatenate(runs)
    bench.compare("clocks of run", recording.rows("run"), running)

    results = recording.rows("store") if twin.results else running[:0]
    stored = np.intersect1d(results, running)
    span = 1 << twin.addr_width
    counts = np.concatenate([np.arange(np.isin(run, stored).sum()) for run in runs])
    # ``finish`` resets the counter, so what is stored in the same clock goes to an unused place.
    with_finish = np.isin(stored, recording.rows("finish"))
    behind = np.where(with_finish, span - 1, (twin.inputs + counts) % span)
    sources = np.concatenate([rows[frames.accept], stored])
    addresses = np.concatenate([frames.addr[frames.accept], behind])
    order = np.argsort(sources)
    kept = recording.undisturbed(sources[order], sources[order])
    kept &= sources[order] < recording.clocks - 1
    cause, address = sources[order][kept], addresses[order][kept]
    bench.compare("clocks of write", recording.rows("write"), cause + 1)
    bench.compare("write_addr", recording.unsigned("write_addr", cause + 1), address, clock=cause)
    wrong = rows[frames.error]
    bench.compare("clocks of frame_error", recording.rows("frame_error"), wrong + 1)
    assert len(wrong), "no wrong frame was driven"
    assert len(ends), "no good frame was driven"
    bench.finish(at_least=SAMPLES // 2)


@cocotb.test()
async def apart(dut):
    bench = Bench(dut)
    await check(bench, gap=0.0, apart=2 * bench.twin.busy, resets=False)


@cocotb.test()
async def too_early(dut):
    bench = Bench(dut)
    await check(bench, gap=0.0, apart=bench.twin.busy, resets=False)


@cocotb.test()
async def gaps(dut):
    bench = Bench(dut)
    await check(bench, gap=0.5, apart=bench.twin.busy, resets=False)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, gap=0.2, apart=bench.twin.busy, resets=True)
