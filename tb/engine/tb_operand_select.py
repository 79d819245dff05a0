"""operand_select against its twin.

Sweeps: every kind with a random code from each of 16384 equal parts of the range; with the codes
around 0, around both ends, and around the borders and the middles of the first segments on either
side of 0; and with random codes.
Drives: a word and a kind every clock.
Checks: the operand bit for bit, and the clock in which it appears.
Does not prove: that every pair of a word and a kind is right.
"""

import cocotb
import numpy as np

from golden.engine.graph import Kind
from golden.engine.operand_memory import WORD
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LESSONS
from tb.common.stimulus import all_codes

CASES = LESSONS


@cocotb.test()
async def kinds(dut):
    bench = Bench(dut)
    half = 1 << (bench.twin.segment_width - 1)
    codes = all_codes(WORD, half * np.arange(1, 9), bench.rng)
    corners = codes[-100:]
    words = np.concatenate([np.repeat(corners, len(Kind)), codes])
    kinds = np.concatenate(
        [np.tile(list(Kind), len(corners)), bench.rng.integers(0, len(Kind), len(codes))]
    )
    recording = await bench.play({"word": words, "kind": kinds}, ["operand"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    seen = recording.signed("word", rows), recording.unsigned("kind", rows)
    bench.meet("word", seen[0])
    got = recording.signed("operand", rows + bench.latency)
    bench.compare("operand", got, bench.twin.process(*seen), word=seen[0], kind=seen[1])
    bench.finish(at_least=16384)
