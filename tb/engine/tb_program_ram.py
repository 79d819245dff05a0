"""program_ram against its twin.

Sweeps: every word of the memory, which is written and then read by the counter.
Drives: random words into every address in random order, and the counter once around the memory;
then runs of random length with ``finish`` and writes at random clocks; then resets, between which
the words around the first word of the program are written and read most often.
Checks: the word bit for bit and its clock, also in clocks of writes, unless a reset comes while it
is on its way.
Does not prove: what is read from a word that has not been written since the last reset; it is
undefined.
"""

import cocotb
import numpy as np

from golden.engine.formats import WORD_WIDTH
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import RELOADED, RELOADED_LANES
from tb.common.stimulus import random_resets, random_runs

CASES = RELOADED | RELOADED_LANES


# With resets, so many words on either side of the first word of the program are used.
NEAR = 16


async def check(bench, run, finish, write, resets):
    """Write every word, then play, and compare what is read from words that were written."""
    twin, rng = bench.twin, bench.rng
    words = 1 << twin.addr_width
    length = words + len(run)
    before = np.zeros(words, dtype=np.int64)
    write_addr = rng.integers(0, words, length)
    write_addr[:words] = rng.permutation(words)
    if resets:
        write_addr[words:] = rng.integers(-NEAR, NEAR, len(run)) % words
    drive = {
        "start": np.concatenate([before, rng.random(len(run)) < 1 / 10]),
        "run": np.concatenate([before, run]),
        "finish": np.concatenate([before, finish]),
        "write": np.concatenate([1 - before, write]),
        "write_addr": write_addr,
        "data": rng.integers(0, 1 << WORD_WIDTH, length),
    }
    if resets:
        drive["rst"] = np.concatenate([before, random_resets(rng, len(run), every=100)])
    recording = await bench.play(drive, ["word"])

    # The counter is at its first word from the last clock of the initial reset on.
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    names = ("start", "run", "finish", "write", "write_addr", "data", "rst")
    flags = {name: recording.unsigned(name, rows) for name in names}
    bench.visit("counter", twin.counter(*(flags[n] for n in ("start", "run", "finish", "rst"))))
    expected = twin.process(*flags.values())
    # A word is not valid if a reset comes while it is on its way.
    known = (expected >= 0) & recording.undisturbed(rows, rows + bench.latency - 1)
    got = recording.unsigned("word", rows[known] + bench.latency)
    bench.compare("word", got, expected[known], clock=rows[known])


def random_writes(rng, length, every):
    """Random runs, and a write in one of ``every`` clocks."""
    return *random_runs(rng, length, longest=60, every=20), rng.random(length) < 1 / every


@cocotb.test()
async def whole_memory(dut):
    bench = Bench(dut)
    words = 1 << bench.twin.addr_width
    length = words + 10
    quiet = np.zeros(length, dtype=np.int64)
    await check(bench, np.ones(length, dtype=np.int64), quiet, quiet, resets=False)
    bench.finish(at_least=words)


@cocotb.test()
async def runs_and_writes(dut):
    bench = Bench(dut)
    await check(bench, *random_writes(bench.rng, 3000, every=10), resets=False)
    bench.finish(at_least=2500)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    await check(bench, *random_writes(bench.rng, 9000, every=2), resets=True)
    bench.finish(at_least=2500)
