"""scan_sequencer against its twin.

Sweeps: every clock of three complete scans, or of as many as fit into 400000 clocks; in each clock
the converter shows another random code.
Drives: scans from the first reset on; then resets at random clocks; then one reset in each clock
around the one in which a code is taken.
Checks: the address in every clock; samples, ``out_last`` and their clocks; that a sample stays
until the next one.
Does not prove: that an analogue multiplexer has settled when the code is taken; what happens at the
end of a scan of more than 400000 clocks.
"""

import cocotb
import numpy as np

from golden.common.border import State
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import INSTRUMENTS
from tb.common.stimulus import random_resets

CASES = {"past-instrument": INSTRUMENTS["past-instrument"], **INSTRUMENTS}

# The clocks from the one in which a code is taken to a reset.
ABOUT = range(-2, 4)
MOST_CLOCKS = 400_000
WATCH = ["address", "out_valid", "out_data", "out_last"]


async def check(bench, clocks, resets=None):
    """Play so many clocks, with a column of resets, and compare."""
    twin = bench.twin
    codes = bench.rng.integers(twin.fmt.low, twin.fmt.high + 1, clocks)
    # Both ends of the range are among the codes that are taken.
    rails = [twin.fmt.low, twin.fmt.high]
    codes = np.where(bench.rng.random(clocks) < 1 / 4, bench.rng.choice(rails, clocks), codes)
    drive = {"adc": codes}
    if resets is not None:
        drive["rst"] = resets
    recording = await bench.play(drive, WATCH)

    # A scan begins in the clock after a reset. A code that is taken in the clock of a reset is
    # lost.
    marks = np.concatenate([[RESET_CLOCKS - 1], recording.resets()])
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    since = rows - marks[np.searchsorted(marks, rows) - 1] - 1
    count = since % twin.scan_clocks
    sampled = np.isin(count, twin.sample_clocks) & ~np.isin(rows, marks)
    taken = rows[sampled]
    taken = taken[taken + bench.latency < recording.clocks]
    left = recording.rows("out_valid")
    bench.compare("clocks of the samples", left, taken + bench.latency)
    adc = recording.signed("adc", taken)
    bench.compare("out_data", recording.signed("out_data", left), adc, clock=taken)
    final = count[taken - RESET_CLOCKS] == twin.sample_clocks[-1]
    bench.compare("clocks of out_last", recording.rows("out_last"), left[final])
    stays = np.flatnonzero(recording.undisturbed(left[:-1], left[1:] - 1))
    kept = recording.signed("out_data", left[stays + 1] - 1)
    bench.compare("kept data", kept, adc[stays], clock=left[stays])
    bench.visit("slot", count // twin.slot_clocks)
    steady = np.flatnonzero(since >= 1)
    expected = twin.address_at(count[steady] - 1)
    address = recording.unsigned("address", rows[steady])
    bench.compare("address", address, expected, clock=since[steady])
    return recording


@cocotb.test()
async def scans(dut):
    """Play complete scans, and check that the codes are those that the twin takes."""
    bench = Bench(dut)
    twin = bench.twin
    count = min(3, MOST_CLOCKS // twin.scan_clocks)
    again = twin.slots * twin.slot_clocks
    recording = await check(bench, count * twin.scan_clocks + again + 2)
    clocks = RESET_CLOCKS + np.arange(count * twin.scan_clocks)
    expected = twin.process(recording.signed("adc", clocks).reshape(count, -1))
    got = recording.signed("out_data", recording.rows("out_valid"))
    bench.compare("frames", got[: expected.size], expected.ravel())
    bench.finish(at_least=max(1, count) * twin.slots)


@cocotb.test()
async def resets(dut):
    """Play resets, after each of which the scan begins again."""
    bench = Bench(dut)
    scan = bench.twin.scan_clocks
    clocks = min(3 * scan, MOST_CLOCKS) + 200
    await check(bench, clocks, random_resets(bench.rng, clocks, min(scan, MOST_CLOCKS // 3)))
    bench.finish(at_least=bench.twin.slots)


@cocotb.test()
async def resets_about_a_sample(dut):
    """Play a reset in each clock around the taking of a code, in the first and the last slot."""
    bench = Bench(dut)
    twin = bench.twin
    at, clock = [], 0
    for sample in (twin.sample_clocks[0], twin.sample_clocks[-1]):
        for offset in ABOUT:
            # The scan begins in the clock after a reset.
            clock += 1 + int(sample) + offset
            at.append(clock)
    resets = np.zeros(clock + min(twin.scan_clocks, MOST_CLOCKS) + 2, dtype=np.int64)
    resets[at] = 1
    recording = await check(bench, len(resets), resets)
    found = recording.resets()
    since = np.diff(found, prepend=RESET_CLOCKS - 1) - 1
    for sample in (twin.sample_clocks[0], twin.sample_clocks[-1]):
        bench.visit(State("reset, in clocks from a sample", ABOUT), since - int(sample))
    bench.finish(at_least=twin.slots)
