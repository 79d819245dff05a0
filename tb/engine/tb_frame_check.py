"""frame_check against its twin.

Sweeps: 1000 samples in frames of the right length, shorter and longer ones, mixed at random.
Drives: frames far enough apart, closer than they are computed, each clock about the first that is
late enough, with gaps, and with resets at random clocks. After each good frame ``finish`` comes in
its clock; ``store`` is high at random while a frame is computed.
Checks: start, run, write, its address and frame_error in their clocks, and that none of the flags
is high in any other clock.
Does not prove: a finish while no frame is computed, which the program rules out.
"""

import cocotb
import numpy as np

from tb.common.bench import Bench
from tb.common.framing import random_lengths, scan
from tb.common.small import ENGINES
from tb.common.stimulus import random_resets, spread

CASES = {name: ENGINES[name] for name in ("rails-engine", "least-engine", "deep-least-engine")}
FAULTS = [
    (r"frame_error <= \(early \|\| broken\)", "frame_error <= broken"),
    (r"dropping <= \(\(!in_last\)", "dropping <= (0"),
    (r"if \(\(finish \|\| broken\)\)", "if (finish)"),
    (r"write <= \(accept \|\| store\)", "write <= accept"),
    (r"if \(rst == 1\) begin", "if (0) begin"),
]

SAMPLES = 1000
# Clocks by which a frame comes later than just too early.
ABOUT = range(-2, 3)


def computed(twin, drive):
    """The clocks of ``finish``, ``busy`` clocks after a good frame as in the engine, and those
    in which a frame is computed.
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
    """The clocks of the last sample of each good frame, and of the sample that opens the next."""
    ends = rows[done]
    opening = rows[1:][last[:-1]]
    good = np.append(-1, ends)[np.searchsorted(ends, opening)]
    return good[good >= 0], opening[good >= 0]


def timeline(bench, gap, apart, resets):
    """Frames with their clocks; ``apart`` is the most idle clocks before each."""
    twin, rng = bench.twin, bench.rng
    last = random_lengths(rng, twin.inputs, SAMPLES)
    (border,) = twin.borders
    # Of four frames one comes about as early as it may.
    about = border.at - 1 + rng.integers(-2, 3, len(last))
    idle = np.where(rng.random(len(last)) < 1 / 4, about, rng.integers(0, apart + 1, len(last)))
    # And at the beginning good ones do: however long frames are, each such distance is there. One
    # that comes too early is refused, so that the next follows no good one.
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
    # In turns some results, and so many that the counter goes around.
    density = np.where(np.arange(length) // (4 * twin.busy) % 2, 0.95, 1 / 3)
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
    # Of samples with no reset between.
    good, opening = openings(rows, np.isin(rows, recording.rows("in_last")), frames.done)
    near = recording.undisturbed(good, opening)
    bench.meet("clocks from a good frame to the next sample", (opening - good)[near])
    # A frame is computed up to ``finish``, or to a reset, or to the end of the recording.
    stops = np.sort(np.concatenate([recording.resets(), [recording.clocks - 1]]))
    until = np.minimum(ends + twin.busy, stops[np.searchsorted(stops, ends)])
    begin = ends + twin.pipeline.run
    # It is not registered, so it may be high in the clock of a reset too.
    started, expected = (
        np.setdiff1d(found, recording.resets()) for found in (recording.rows("start"), begin - 1)
    )
    bench.compare("clocks of start", started, expected)
    runs = [np.arange(a, b + 1) for a, b in zip(begin, until, strict=True)]
    running = np.concatenate(runs)
    bench.compare("clocks of run", recording.rows("run"), running)

    stored = np.intersect1d(recording.rows("store"), running)
    span = 1 << twin.addr_width
    counts = np.concatenate([np.arange(np.isin(run, stored).sum()) for run in runs])
    # ``finish`` puts the counter back, so what is stored with it goes where nothing is kept.
    with_finish = np.isin(stored, recording.rows("finish"))
    results = np.where(with_finish, span - 1, (twin.inputs + counts) % span)
    sources = np.concatenate([rows[frames.accept], stored])
    addresses = np.concatenate([frames.addr[frames.accept], results])
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
