"""table_address against its twin.

Sweeps: every one of the 2^18 codes of a hidden sum.
Drives: in order.
Checks: the segment's address, in its clock.
Does not prove: that the table holds the right words (tests/test_tanh_table.py does).
"""

import cocotb
import numpy as np

from golden.engine.formats import HIDDEN
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.small import ENGINE_PARTS

CASES = {"rails-engine": ENGINE_PARTS["rails-engine"]}
FAULTS = [
    (r"high = \(~part\)", "high = part"),
    (r"top > (\d+)", r"top > \1 + 1"),
]


@cocotb.test()
async def every_code(dut):
    bench = Bench(dut)
    # In pieces, so that a fault is found before the end.
    for codes in np.array_split(np.arange(HIDDEN.low, HIDDEN.high + 1), 8):
        tail = codes[: bench.latency]
        recording = await bench.play({"q": np.concatenate([codes, tail])}, ["addr"])
        rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
        seen = recording.signed("q", rows)
        got = recording.unsigned("addr", rows + bench.latency)
        bench.compare("addr", got, bench.twin.process(seen), q=seen)
    bench.finish(at_least=1 << HIDDEN.width)
