"""program_ram against its twin.

Sweeps: every word of the memory, written and read by the counter; every segment's address that the
port can carry.
Drives: random words into every address in random order, the counter once around the memory; then
runs of random length with ``finish`` and writes at random clocks; then resets, between which the
words around the program's first one are written, and read, most often. The table's port carries a
random segment in every clock, and asks in two of three.
Checks: both words bit for bit, in their clocks, in the clocks of writes too, unless a reset cuts
them on their way.
Does not prove: what is read where nothing was written since the last reset, which is undefined.
"""

import cocotb
import numpy as np

from golden.engine.program import WORD_WIDTH
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.small import RELOADED
from tb.common.stimulus import random_resets, random_runs

CASES = RELOADED
FAULTS = [
    (r"stands = \(finish \|\| ", "stands = ("),
    (r"if \(rst == 1\)", "if (0)"),
    (r"asked = \(look_up && \(!write\)\)", "asked = look_up"),
    (r"addr = write_addr", "addr = counter"),
    (r"(memory\[addr\] <= \S+);", r"\1 ^ 1;"),
]


# With resets: so many words on either side of the program's first one.
NEAR = 16


async def check(bench, run, finish, write, resets):
    """Write every word, then play; compare what is read of words that were written."""
    twin, rng = bench.twin, bench.rng
    words = 1 << twin.addr_width
    length = words + len(run)
    before = np.zeros(words, dtype=np.int64)
    write_addr = rng.integers(0, words, length)
    write_addr[:words] = rng.permutation(words)
    segment = rng.integers(0, 1 << twin.segment_addr_width, length)
    if resets:
        write_addr[words:] = twin.begin + rng.integers(-NEAR, NEAR, len(run))
        segment[words:] = twin.begin - rng.integers(1, NEAR + 1, len(run))
    drive = {
        "start": np.concatenate([before, rng.random(len(run)) < 1 / 10]),
        "run": np.concatenate([before, run]),
        "finish": np.concatenate([before, finish]),
        "segment": segment,
        "look_up": rng.random(length) < 2 / 3,
        "write": np.concatenate([1 - before, write]),
        "write_addr": write_addr,
        "data": rng.integers(0, 1 << WORD_WIDTH, length),
    }
    if resets:
        drive["rst"] = np.concatenate([before, random_resets(rng, len(run), every=100)])
    recording = await bench.play(drive, ["word", "table_word"])

    # From the last clock of the initial reset on the counter stands.
    rows = np.arange(RESET_CLOCKS, recording.clocks - twin.look_up_latency)
    names = (
        "start",
        "run",
        "finish",
        "segment",
        "look_up",
        "write",
        "write_addr",
        "data",
        "rst",
    )
    read = [recording.unsigned(name, rows) for name in names]
    flags = dict(zip(names, read, strict=True))
    bench.visit("counter", twin.counter(*(flags[n] for n in ("start", "run", "finish", "rst"))))
    latencies = {"word": twin.latency, "table_word": twin.look_up_latency}
    for (name, clocks), expected in zip(latencies.items(), twin.process(*read), strict=True):
        # What a reset cuts on its way is not valid.
        known = (expected >= 0) & recording.undisturbed(rows, rows + clocks - 1)
        got = recording.unsigned(name, rows[known] + clocks)
        bench.compare(name, got, expected[known], clock=rows[known])


def random_writes(rng, length, every):
    """Runs, and a write in one of so many clocks."""
    return *random_runs(rng, length, longest=60, every=20), rng.random(length) < 1 / every


@cocotb.test()
async def whole_memory(dut):
    bench = Bench(dut)
    length = (1 << bench.twin.addr_width) + 10
    quiet = np.zeros(length, dtype=np.int64)
    await check(bench, np.ones(length, dtype=np.int64), quiet, quiet, resets=False)
    bench.finish(at_least=2 * length)


@cocotb.test()
async def runs_and_writes(dut):
    bench = Bench(dut)
    await check(bench, *random_writes(bench.rng, 3000, every=10), resets=False)
    bench.finish(at_least=5000)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, *random_writes(bench.rng, 9000, every=2), resets=True)
    bench.finish(at_least=5000)
