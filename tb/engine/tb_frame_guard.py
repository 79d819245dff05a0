"""frame_guard against its twin.

Sweeps: at least 1500 samples in a random mixture of frames of the right length, shorter and longer
ones. The right length changes: it is one sample, a few samples, and up to as many as the memory has
words.
Drives: frames that come before the last one is computed and frames further apart, with gaps; halts
of random length at random clocks in which no frame is computed; results at random clocks in which a
frame is computed; ``finish`` after a random time; then resets at random clocks.
Checks: every output in every clock, and ``write_addr`` in the clocks in which something is written.
Does not prove: what a halt does while a frame is computed; ``image_loader`` rules it out.
"""

import time
from collections.abc import Iterator

import cocotb
import numpy as np

from tb.common.bench import RESET_CLOCKS, Bench, Recording, each_half, reader, writer
from tb.common.case_library import RELOADED, RELOADED_LANES
from tb.common.framing import random_lengths
from tb.common.stimulus import random_resets, spread

CASES = RELOADED | RELOADED_LANES

SAMPLES = 1500
INPUTS = ("in_valid", "in_last", "halt", "before_last", "store", "finish", "rst")
OUTPUTS = ("start", "run", "busy", "write", "write_addr", "frame_error")


async def play(bench, drive, halts, lengths):
    """Play columns, and halt in the clocks of ``halts`` in which no frame is computed.

    ``finish`` ends each frame after as many clocks as the next of ``lengths`` says.
    """
    ports = [*INPUTS, *OUTPUTS]
    read = reader(bench.dut, ports)
    writes = {name: writer(bench.dut, name) for name in ("clk", *INPUTS)}
    asked = reader(bench.dut, ["run", "busy"])
    columns = {name: [int(value) for value in column] for name, column in drive.items()}
    words: list[str] = []

    def halves() -> Iterator[None]:
        since = number = 0
        for clock in range(-RESET_CLOCKS, len(halts)):
            # The outputs already have the values that the last rising edge gave them.
            run, busy = asked()
            for name, column in columns.items():
                writes[name](column[clock] if clock >= 0 else int(name == "rst"))
            since = since + 1 if run == "1" else 0
            finish = since >= lengths[number]
            number += finish
            writes["finish"](int(finish))
            writes["store"](int(since and columns["store"][max(clock, 0)]))
            writes["halt"](int(clock >= 0 and halts[clock] and busy == "0"))
            writes["clk"](0)
            yield
            words.extend(read())
            writes["clk"](1)
            yield

    started = time.perf_counter()
    await each_half(halves())
    return bench.watched(Recording(ports, words, time.perf_counter() - started))


async def check(bench, gap, resets):
    twin, rng = bench.twin, bench.rng
    words = 1 << twin.addr_width
    # Every bit of the counter and of its end is used. A halt covers each change in mid-frame.
    half = int(rng.integers(words // 4, words // 2))
    parts = []
    for samples in (1, int(rng.integers(3, 7)), 2, half, 8, words - 1):
        last = random_lengths(rng, samples, max(SAMPLES // 6, 6 * samples))
        pause = np.roll(last, 1) * rng.integers(0, 30, len(last))
        one = spread(rng, {"in_last": last}, "in_valid", gap, tail=40, pause=pause)
        count = len(one["in_valid"])
        one["before_last"] = np.full(count, (samples - 2) % words)
        # Resets are rare enough that long frames are completed.
        rate = 1 / max(30, 6 * samples)
        one["halts"] = np.repeat(rng.random(count) < rate, rng.integers(1, 9, count))[:count]
        one["halts"][-15:] = True
        parts.append(one)
    drive = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    halts = drive.pop("halts")
    drive["store"] = rng.random(len(halts)) < 1 / 3
    drive["rst"] = np.zeros(len(halts), dtype=np.int64)
    if resets:
        drive["rst"] = random_resets(rng, len(halts), every=80)
    recording = await play(bench, drive, halts, rng.integers(1, 25, len(halts)))

    rows = np.arange(RESET_CLOCKS, recording.clocks)
    guarded = twin.process(*(recording.unsigned(name, rows) for name in INPUTS))
    # In the clock of a reset ``start`` has no effect, because the counter is reset.
    alive = np.setdiff1d(rows, recording.resets())
    got = recording.unsigned("start", alive)
    bench.compare("start", got, guarded.start[alive - rows[0]].astype(np.int64), clock=alive)
    for name in ("run", "busy", "write", "frame_error"):
        got = recording.unsigned(name, rows)
        bench.compare(name, got, getattr(guarded, name).astype(np.int64), clock=rows)
    written = rows[guarded.write]
    got = recording.unsigned("write_addr", written)
    bench.compare("write_addr", got, guarded.write_addr[guarded.write], clock=written)
    assert guarded.done.any(), "no good frame was driven"
    assert guarded.frame_error.any(), "no wrong frame was driven"
    bench.finish(at_least=4 * SAMPLES)


@cocotb.test()
async def close(dut):
    await check(Bench(dut), gap=0.0, resets=False)


@cocotb.test()
async def gaps(dut):
    await check(Bench(dut), gap=0.5, resets=False)


@cocotb.test()
async def resets(dut):
    await check(Bench(dut), gap=0.2, resets=True)
