"""exp_interpolator against its twin.

Sweeps: every word of the memory with the least, the largest and two random offsets; 2000 random
words up to the largest word of the memory, with random offsets.
Drives: the inputs that the recorded frames bring, back to back; then those of the sweep likewise,
and in random order with gaps and resets.
Checks: the result bit for bit, and the clock in which it appears.
Does not prove: anything about words above the largest word of the memory, whose result may wrap;
how close the result is to exp(-x) (tests/test_visualisation.py bounds the profile).
"""

import cocotb
import numpy as np

from golden.visualisation.load_profile import LoadProfile
from tb.common.bench import Bench
from tb.common.case_library import DRAWN
from tb.common.recorded_frames import check_recorded
from tb.common.stream import UNSIGNED, check_gaps_and_resets, check_stream

CASES = DRAWN

INPUTS = {"in_word": UNSIGNED, "in_offset": UNSIGNED}
OUTPUTS = {"out_data": UNSIGNED}


def pairs(bench):
    words = np.array(bench.around(LoadProfile)[0].exp_memory.words)
    top = (1 << bench.twin.offset_width) - 1
    random = bench.rng.integers(0, words.max() + 1, 2000)
    offsets = [np.full(len(words), fixed) for fixed in (0, top)]
    offsets.append(bench.rng.integers(0, top + 1, 2 * len(words) + len(random)))
    return {
        "in_word": np.concatenate([np.tile(words, 4), random]),
        "in_offset": np.concatenate(offsets),
    }


@cocotb.test()
async def what_recorded_frames_bring(dut):
    bench = Bench(dut)
    await check_recorded(bench, INPUTS, OUTPUTS, bench.twin.process)


@cocotb.test()
async def sweep(dut):
    bench = Bench(dut)
    items = pairs(bench)
    await check_stream(bench, items, INPUTS, OUTPUTS, bench.twin.process)
    bench.finish(at_least=len(items["in_word"]))


@cocotb.test()
async def gaps_and_resets(dut):
    bench = Bench(dut)
    await check_gaps_and_resets(bench, pairs(bench), INPUTS, OUTPUTS, bench.twin.process)
