"""program_memory against its twin.

Sweeps: every word of the program and the words after it, and the address of every segment that the
port can carry.
Drives: the counter once around the memory; then runs of random length with ``finish`` at random
clocks, also together with ``run``; then resets. The port of the table, if there is one, carries a
random segment in every clock, and a word is requested in two of three clocks.
Checks: both words bit for bit and their clocks, unless a reset comes while they are on their way.
Does not prove: that the program is the right one (tests/test_engine.py does).
"""

import cocotb
import numpy as np

from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import ENGINE_PARTS, LANES, TABLES
from tb.common.stimulus import look_ups, random_resets, random_runs

CASES = ENGINE_PARTS | {"tables-engine": TABLES["tables-engine"]}
CASES |= {name: LANES[name] for name in ("rails-lanes", "deep-lanes")}
# The first has registers behind the memory; the second has tables of several functions.
ALSO = ("deep-engine", "tables-engine")


async def check(bench, start, run, finish, resets):
    twin, rng = bench.twin, bench.rng
    length = len(run)
    # Without a table nothing is looked up.
    asked = look_ups(rng, 1 << twin.segment_addr_width, length) if twin.table else {}
    drive = {"start": start, "run": run, "finish": finish, **asked}
    if resets:
        drive["rst"] = random_resets(rng, length, every=40)
    names = ["word", "table_word"] if twin.table else ["word"]
    recording = await bench.play(drive, names)

    # The counter is at its first word from the last clock of the initial reset on.
    rows = np.arange(RESET_CLOCKS, recording.clocks - twin.look_up_latency)
    flags = [recording.unsigned(name, rows) for name in ("start", "run", "finish", "rst")]
    bench.visit("counter", twin.counter(*flags))
    columns = {"word": (bench.latency, twin.process(*flags))}
    if twin.table:
        seen = [recording.unsigned(name, rows) for name in ("segment", "look_up")]
        columns["table_word"] = twin.look_up_latency, twin.look_up(*seen)
    for name, (clocks, expected) in columns.items():
        # A word is not valid if a reset comes while it is on its way.
        whole = recording.undisturbed(rows, rows + clocks - 1)
        got = recording.unsigned(name, rows[whole] + clocks)
        bench.compare(name, got, expected[whole], clock=rows[whole])


def random_steps(rng, length):
    """Random runs, and a start in one of 20 clocks."""
    return rng.random(length) < 1 / 20, *random_runs(rng, length, longest=60, every=20)


# Results of random runs where both words are compared; without a table there is one.
AT_LEAST = 5000


@cocotb.test()
async def whole_memory(dut):
    bench = Bench(dut)
    length = len(bench.twin.contents) + 10
    await check(bench, np.zeros(length), np.ones(length), np.zeros(length), resets=False)
    bench.finish(at_least=length if bench.twin.table else len(bench.twin.contents))


@cocotb.test()
async def runs(dut):
    bench = Bench(dut)
    await check(bench, *random_steps(bench.rng, 3000), resets=False)
    bench.finish(at_least=AT_LEAST if bench.twin.table else AT_LEAST // 2)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, *random_steps(bench.rng, 3000), resets=True)
    bench.finish(at_least=AT_LEAST if bench.twin.table else AT_LEAST // 2)
