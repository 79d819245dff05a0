"""serial_accumulate against its twin.

Sweeps: 8000 words with random coefficients, a third of which are corners: both ends and their
neighbours, 0, 1 and -1.
Drives: a word in every clock, in random planes; one in three words is the first of a pass. The
coefficient comes from the program, from the table, or from both, which no program does. Some sums
are those of outputs.
Checks: the sum after each word bit for bit, and the clock in which it appears, even if the sum
overflows.
Does not prove: that every coefficient is right.
"""

import cocotb
import numpy as np

from golden.engine.formats import WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.replay import CLEAR
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import SERIAL_PARTS

CASES = SERIAL_PARTS

CORNERS = [WORD.low, WORD.low + 1, -1, 0, 1, WORD.high - 1, WORD.high]
WORDS = 8000


def words(rng):
    """Random codes as bits, a third of which are corners."""
    random = rng.integers(WORD.low, WORD.high + 1, WORDS)
    codes = np.where(rng.random(WORDS) < 1 / 3, rng.choice(CORNERS, WORDS), random)
    return codes & ((1 << WIDTH) - 1)


def timeline(rng):
    """The columns of the ports. The first word clears; words of the table come a clock later."""
    plane = rng.integers(0, CLEAR + 1, WORDS)
    # Passes that clear the sum are rare, so that sums grow.
    plane = np.where((plane == CLEAR) & (rng.random(WORDS) < 2 / 3), 0, plane)
    plane[0] = CLEAR
    source = rng.integers(0, 5, WORDS)
    drive = {
        "weight": words(rng),
        "take_weight": source != 0,
        "subtract": rng.integers(0, 2, WORDS),
        "plane": 1 << plane,
        "first": rng.random(WORDS) < 1 / 3,
        "of_output": rng.integers(0, 2, WORDS),
    }
    fill = np.zeros(3, dtype=np.int64)
    columns = {name: np.concatenate([column, fill]) for name, column in drive.items()}
    table = np.where(source < 2, words(rng), 0)
    return columns | {"table_word": np.concatenate([fill[:1], table, fill[1:]])}


@cocotb.test()
async def sums(dut):
    bench = Bench(dut)
    recording = await bench.play(timeline(bench.rng), ["acc"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    names = ("weight", "take_weight", "subtract", "plane", "first", "of_output")
    seen = [recording.unsigned(name, rows) for name in names]
    table = recording.unsigned("table_word", rows + 1)
    expected = bench.twin.process(*seen, table)
    got = recording.signed("acc", rows + bench.latency)
    bench.compare("acc", got, expected, weight=seen[0], table_word=table, plane=seen[3])
    bench.finish(at_least=WORDS)
