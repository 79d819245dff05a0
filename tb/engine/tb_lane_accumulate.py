"""lane_accumulate against its twin.

Sweeps: 8000 products in sums of one to twelve products. Words, coefficients and the sums of other
lanes are random; a third of them are corners: both ends and their neighbours, 0, 1 and -1. Every
kind of operand, every kind of start, and the sum of each other lane in place of a product.
Drives: a product or another sum every clock.
Checks: the sum after each step bit for bit, whether it is above or below every word, and the clock
in which it appears, even if the sum overflows.
Does not prove: that every possible product is right.
"""

import cocotb
import numpy as np

from golden.engine.formats import DROPPED, WIDTH
from golden.engine.graph import Kind
from golden.engine.lane_accumulate import beyond
from golden.engine.operand_memory import WORD
from golden.numbers.fixed import Fix
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LANES

CASES = {name: LANES[name] for name in ("rails-lanes", "relu-lanes")}
# It has no table, and the sums of three lanes to add.
ALSO = ("relu-lanes",)

CORNERS = [WORD.low, WORD.low + 1, -1, 0, 1, WORD.high - 1, WORD.high]
PRODUCTS = 8000
# After the word come the coefficient and the start, then the bits that name another sum, then this.
COEFF, GATHER, OTHER = 1, 2, 3


def words(rng):
    """Random signed codes, a third of which are corners."""
    random = rng.integers(WORD.low, WORD.high + 1, PRODUCTS)
    return np.where(rng.random(PRODUCTS) < 1 / 3, rng.choice(CORNERS, PRODUCTS), random)


def later(column, clocks, latency):
    """A column that comes some clocks after the word, with zeros around it."""
    return np.concatenate(
        [np.zeros(clocks, np.int64), column, np.zeros(latency - clocks, np.int64)]
    )


def timeline(bench):
    """The columns of the ports. A sum starts with the first product, and then with one of six."""
    twin, rng = bench.twin, bench.rng
    opens = np.where(rng.random(PRODUCTS) < 1 / 6, rng.integers(1, 4, PRODUCTS), 0)
    kinds = rng.integers(0, 4, PRODUCTS)
    word, coeff = words(rng), words(rng)
    # The first sums end next to both ends of the word. A sum starts with half a unit.
    half = 1 << (DROPPED - 1)
    word[:8] = [WORD.low, -half, WORD.low, -half - 1] * 2
    coeff[:8] = [1 << DROPPED, 1, 1 << DROPPED, 1, -1 << DROPPED, 1, -1 << DROPPED, 1]
    opens[:8], kinds[:8] = [1, 0] * 4, Kind.WORD
    columns = {
        "word": (0, word),
        "kind": (0, kinds),
        "coeff": (COEFF, coeff & ((1 << WIDTH) - 1)),
        "opens": (COEFF, opens),
    }
    if twin.partners:
        named = rng.integers(1, 1 << twin.partners, PRODUCTS)
        columns["gather"] = GATHER, np.where(rng.random(PRODUCTS) < 1 / 4, named, 0)
        columns["gather"][1][:8] = 0
        acc = Fix(twin.acc_width, 0)
        for n in range(twin.partners):
            other = rng.integers(acc.low, acc.high + 1, PRODUCTS) >> rng.integers(0, 20, PRODUCTS)
            other[rng.integers(0, PRODUCTS, 100)] = rng.choice([acc.low, acc.high, 0], 100)
            columns[f"other_{n}"] = OTHER, other
    return {name: later(column, at, bench.latency) for name, (at, column) in columns.items()}


@cocotb.test()
async def sums(dut):
    bench = Bench(dut)
    twin = bench.twin
    recording = await bench.play(timeline(bench), ["acc", "high", "low"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    word, kind = recording.signed("word", rows), recording.unsigned("kind", rows)
    late = [recording.unsigned(name, rows + COEFF) for name in ("coeff", "opens")]
    gather = recording.unsigned("gather", rows + GATHER) if twin.partners else 0
    others = [recording.signed(f"other_{n}", rows + OTHER) for n in range(twin.partners)]
    expected = twin.process(word, kind, *late, gather, others)
    bench.meet("word", word)
    bench.meet("sum", expected)
    got = recording.signed("acc", rows + bench.latency)
    bench.compare("acc", got, expected, word=word, kind=kind, coeff=late[0], opens=late[1])
    for name, flags in zip(("high", "low"), beyond(expected), strict=True):
        got = recording.unsigned(name, rows + bench.latency)
        bench.compare(name, got, flags, acc=expected)
    bench.finish(at_least=3 * PRODUCTS)
