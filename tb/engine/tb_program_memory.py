"""program_memory against its twin.

Sweeps: every word of the program and the words after it.
Drives: the counter once around the memory; then runs of random length with ``finish`` at random
clocks, also together with ``run``; then resets.
Checks: the word bit for bit and its clock, unless a reset comes while it is on its way.
Does not prove: that the program is the right one (tests/test_engine.py does).
"""

import cocotb
import numpy as np

from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LANES
from tb.common.stimulus import random_resets, random_runs

# It has registers behind the memory.
ALSO = ("deep-lanes",)
CASES = {name: LANES[name] for name in ("rails-lanes", *ALSO)}


async def check(bench, start, run, finish, resets):
    twin = bench.twin
    drive = {"start": start, "run": run, "finish": finish}
    if resets:
        drive["rst"] = random_resets(bench.rng, len(run), every=40)
    recording = await bench.play(drive, ["word"])

    # The counter is at its first word from the last clock of the initial reset on.
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    flags = [recording.unsigned(name, rows) for name in ("start", "run", "finish", "rst")]
    bench.visit("counter", twin.counter(*flags))
    # The word is not valid if a reset comes while it is on its way.
    whole = recording.undisturbed(rows, rows + bench.latency - 1)
    got = recording.unsigned("word", rows[whole] + bench.latency)
    bench.compare("word", got, twin.process(*flags)[whole], clock=rows[whole])


def random_steps(rng, length):
    """Random runs, and a start in one of 20 clocks."""
    return rng.random(length) < 1 / 20, *random_runs(rng, length, longest=60, every=20)


AT_LEAST = 2500


@cocotb.test()
async def whole_memory(dut):
    bench = Bench(dut)
    length = len(bench.twin.contents) + 10
    await check(bench, np.zeros(length), np.ones(length), np.zeros(length), resets=False)
    bench.finish(at_least=len(bench.twin.contents))


@cocotb.test()
async def runs(dut):
    bench = Bench(dut)
    await check(bench, *random_steps(bench.rng, 3000), resets=False)
    bench.finish(at_least=AT_LEAST)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, *random_steps(bench.rng, 3000), resets=True)
    bench.finish(at_least=AT_LEAST)
