"""table_address against its twin.

Sweeps: all 2^18 codes of a hidden sum. If no sum reaches the end of the table, four codes of every
segment, with both of its ends among them, in each block of the table, with and without another
block for negative sums.
Drives: the codes in their order, for one block after the other.
Checks: the segment's address, in its clock.
Does not prove: that the table holds the right words (tests/test_precise.py does).
"""

import cocotb
import numpy as np

from golden.engine.formats import HIDDEN
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import SERIAL_ENGINES

# The addresses of the last two have the number of a block, of several bits or of one.
ALSO = ("tables-serial", "bell-serial")
CASES = {name: SERIAL_ENGINES[name] for name in ("rails-serial", "fine-serial", *ALSO)}


@cocotb.test()
async def segments(dut):
    bench = Bench(dut)
    codes = np.arange(HIDDEN.low, HIDDEN.high + 1)
    if not bench.twin.beyond:
        width = bench.twin.segment_width
        within = codes & ((1 << width) - 1)
        codes = codes[np.isin(within, [0, 1, (1 << width) - 2, (1 << width) - 1])]
    named = [port.name for port in bench.twin.base_ports]
    bases = np.arange(1 << bench.twin.base_width if named else 1)
    base, codes = np.repeat(bases, len(codes)), np.tile(codes, len(bases))
    # The codes are played in pieces, so that a fault is found before the end.
    for here, piece in zip(np.array_split(base, 8), np.array_split(codes, 8), strict=True):
        drive = {"q": np.concatenate([piece, piece[: bench.latency]])}
        if named:
            drive["base"] = np.concatenate([here, here[: bench.latency]])
        recording = await bench.play(drive, ["addr"])
        rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
        seen = recording.signed("q", rows)
        bench.meet("q", seen)
        got = recording.unsigned("addr", rows + bench.latency)
        base_seen = recording.unsigned("base", rows) if named else np.zeros(len(rows), int)
        bench.compare("addr", got, bench.twin.process(seen, base_seen), q=seen, base=base_seen)
    bench.finish(at_least=len(codes))
