"""lane_memory against its twin.

Sweeps: every weight, with each kind that reads weights. Where there is a table: four codes of every
segment that a code of a hidden sum can lie in, with both of its ends among them, on either side of
0, each with both kinds that look up, and in each block if there are several.
Drives: a place, a word and a kind every clock, in random order. A memory that can be written gets
random words at every address first, and then at random ones, half of them those that are read.
Checks: the coefficient bit for bit, and the clock in which it appears.
Does not prove: that the weights are the right ones (tests/test_engine.py does).
"""

import cocotb
import numpy as np

from golden.engine.formats import HIDDEN, WIDTH
from golden.engine.graph import Kind
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LANES, RELOADED_LANES

# The first has weights alone, the second smaller segments, and the others several blocks.
ALSO = ("relu-lanes", "layers-lanes", "tables-lanes", "bell-lanes")
CASES = {name: LANES[name] for name in ("rails-lanes", *ALSO)} | RELOADED_LANES


def timeline(bench):
    """The columns of the ports."""
    twin, rng = bench.twin, bench.rng
    places = np.arange(len(twin.weights))
    if not twin.table:
        return {"place": np.concatenate([rng.permutation(places), places[:1]])}
    codes = np.arange(HIDDEN.low, HIDDEN.high + 1)
    within = codes & ((1 << twin.segment_width) - 1)
    last = (1 << twin.segment_width) - 1
    words = codes[np.isin(within, [0, 1, last - 1, last])]
    # What a place can name where a function is looked up.
    names = np.arange(2 * twin.blocks) if twin.blocks > 1 else np.zeros(1, dtype=np.int64)
    kinds = [Kind.INTERCEPT, Kind.DISTANCE] * len(names) + [Kind.WORD, Kind.ONE]
    count = len(kinds) * len(words)
    order = rng.permutation(count)
    # Each place is read often.
    place = np.resize(places, count)
    if twin.blocks > 1:
        named = np.repeat(names, 2 * len(words))
        place[: len(named)] = named
    columns = {
        "place": place,
        "word": np.tile(words, len(kinds)),
        "kind": np.repeat(kinds, len(words)),
    }
    return {name: np.append(column[order], 0) for name, column in columns.items()}


def with_writes(bench, drive):
    """The columns with those of writes, and the number of clocks in which every word is written."""
    twin, rng = bench.twin, bench.rng
    words, length = len(twin.contents), len(drive["place"])
    read = twin.address(drive["place"], drive["word"], drive["kind"])
    some = np.where(rng.random(length) < 1 / 2, read, rng.integers(0, words, length))
    writes = {
        "write": np.concatenate([np.ones(words, dtype=np.int64), rng.random(length) < 1 / 4]),
        "write_addr": np.concatenate([rng.permutation(words), some]),
        "data": rng.integers(0, 1 << WIDTH, words + length),
    }
    longer = {name: np.concatenate([np.zeros(words, np.int64), c]) for name, c in drive.items()}
    return longer | writes, words


@cocotb.test()
async def coefficients(dut):
    bench = Bench(dut)
    twin, drive, before = bench.twin, timeline(bench), 0
    if twin.written:
        drive, before = with_writes(bench, drive)
    recording = await bench.play(drive, ["coeff"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    seen = [recording.unsigned("place", rows)]
    if twin.table:
        seen += [recording.signed("word", rows), recording.unsigned("kind", rows)]
        bench.meet("word", seen[1])
    if twin.written:
        seen += [recording.unsigned(name, rows) for name in ("write", "write_addr", "data")]
        expected = twin.process_written(*seen)[before:]
    else:
        expected = twin.process(*seen)
    got = recording.unsigned("coeff", rows[before:] + bench.latency)
    known = expected >= 0
    bench.compare("coeff", got[known], expected[known], place=seen[0][before:][known])
    bench.finish(at_least=len(twin.weights))
