"""multiply_accumulate against its twin.

Sweeps: 8000 products in sums of one to twelve products. Operands and coefficients are random; a
third of them are corners: both ends and their neighbours, 0, 1 and -1.
Drives: a product every clock. The coefficient comes from the program, from either half of the
table's word, or from both, which no program does.
Checks: the sum after each product bit for bit, and the clock in which it appears, even if the sum
overflows.
Does not prove: that every possible product is right.
"""

import cocotb
import numpy as np

from golden.engine.formats import WIDTH
from golden.engine.operand_memory import WORD
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LESSONS

CASES = LESSONS

CORNERS = [WORD.low, WORD.low + 1, -1, 0, 1, WORD.high - 1, WORD.high]
PRODUCTS = 8000
# The flag that starts a sum belongs to a product that entered two clocks before.
ON_ITS_WAY = 2


def words(rng):
    """Random signed codes, a third of which are corners."""
    random = rng.integers(WORD.low, WORD.high + 1, PRODUCTS)
    return np.where(rng.random(PRODUCTS) < 1 / 3, rng.choice(CORNERS, PRODUCTS), random)


def timeline(rng, latency):
    """The columns of the ports. A sum starts with the first product, and then with one of six."""
    mask = (1 << WIDTH) - 1
    weight, intercept, slope = (words(rng) & mask for _ in range(3))
    source = rng.integers(0, 5, PRODUCTS)
    table = np.where(source < 3, 0, (intercept << WIDTH) | slope)
    first = rng.random(PRODUCTS) < 1 / 6
    first[0] = True
    of_output = first & (rng.random(PRODUCTS) < 1 / 2)
    # These products only fill the pipeline.
    end = np.zeros(latency, dtype=np.int64)
    begin, more = np.split(end, [ON_ITS_WAY])
    return {
        "operand": np.concatenate([words(rng), end]),
        "weight": np.concatenate([np.where(source == 3, 0, weight), end]),
        "take_intercept": np.concatenate([rng.integers(0, 2, PRODUCTS), end]),
        "table_word": np.concatenate([table, end]),
        "first": np.concatenate([begin, first, more]),
        "first_of_output": np.concatenate([begin, of_output, more]),
    }


@cocotb.test()
async def sums(dut):
    bench = Bench(dut)
    recording = await bench.play(timeline(bench.rng, bench.latency), ["acc"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    operand = recording.signed("operand", rows)
    names = ("weight", "take_intercept", "table_word")
    seen = [recording.unsigned(name, rows) for name in names]
    late = rows + ON_ITS_WAY
    starts = [recording.unsigned(name, late) for name in ("first", "first_of_output")]
    expected = bench.twin.process(operand, *seen, *starts)
    got = recording.signed("acc", rows + bench.latency)
    bench.compare("acc", got, expected, operand=operand, weight=seen[0], table_word=seen[2])
    bench.finish(at_least=PRODUCTS)
