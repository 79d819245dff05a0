"""table_address against its twin.

Sweeps: all 2^18 codes of a hidden sum. If no sum reaches the end of the table, four codes of every
segment, with both of its ends among them.
Drives: the codes in their order.
Checks: the segment's address, in its clock.
Does not prove: that the table holds the right words (tests/test_tanh_table.py does).
"""

import cocotb
import numpy as np

from golden.engine.formats import HIDDEN
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.small import ENGINES

CASES = {name: ENGINES[name] for name in ("rails-engine", "fine-engine")}
FAULTS = [
    (r"high = \(~part\)", "high = part"),
    (r"top > (\d+)", r"top > \1 + 1"),
]


@cocotb.test()
async def segments(dut):
    bench = Bench(dut)
    codes = np.arange(HIDDEN.low, HIDDEN.high + 1)
    if not bench.twin.beyond:
        width = bench.twin.segment_width
        within = codes & ((1 << width) - 1)
        codes = codes[np.isin(within, [0, 1, (1 << width) - 2, (1 << width) - 1])]
    # The codes are played in pieces, so that a fault is found before the end.
    for piece in np.array_split(codes, 8):
        drive = {"q": np.concatenate([piece, piece[: bench.latency]])}
        recording = await bench.play(drive, ["addr"])
        rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
        seen = recording.signed("q", rows)
        bench.meet("q", seen)
        got = recording.unsigned("addr", rows + bench.latency)
        bench.compare("addr", got, bench.twin.process(seen), q=seen)
    bench.finish(at_least=len(codes))
