"""pulse_density against its twin.

Sweeps: random codes, both ends, and the codes around the middle.
Drives: a new code in every clock, then a new code in about one clock of a hundred; resets.
Checks: the bit in every clock.
Does not prove: what the low pass after it gives (tests/test_link.py shows how many ones come).
"""

import cocotb
import numpy as np

from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import UART
from tb.common.stimulus import random_resets

CASES = {"uart": UART}


async def check(bench, length, chance, resets=False):
    fmt, rng = bench.twin.fmt, bench.rng
    data = rng.integers(fmt.low, fmt.high + 1, length)
    marks = [fmt.low, fmt.high, -1, 0, 1]
    data = np.where(rng.random(length) < 1 / 4, rng.choice(marks, length), data)
    new = np.where(rng.random(length) < chance, np.arange(length), 0)
    drive = {"in_data": data[np.maximum.accumulate(new)]}
    if resets:
        drive["rst"] = random_resets(rng, length, 200)
    recording = await bench.play(drive, ["out_bit"])
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    seen = recording.signed("in_data", rows), recording.unsigned("rst", rows)
    got = recording.unsigned("out_bit", rows)
    bench.compare("out_bit", got, bench.twin.process(*seen), clock=rows)


@cocotb.test()
async def codes(dut):
    bench = Bench(dut)
    await check(bench, 2000, 1.0)
    await check(bench, 6000, 0.01)
    await check(bench, 1000, 0.3, resets=True)
    bench.finish(at_least=9000)
