"""plane_select against its twin.

Sweeps: every kind in every plane with 200 words. Among these are both ends, 0, 1, -1, the words
with one bit set, and the words with one bit cleared.
Drives: one combination a clock, in random order.
Checks: ``take_weight`` and ``look_up``, and ``subtract`` in the clocks in which something is added.
Does not prove: what happens with more than one bit of ``plane``, which the program never has.
"""

import cocotb
import numpy as np

from golden.engine.formats import WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.replay import CLEAR
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import SERIAL_PARTS

CASES = SERIAL_PARTS


@cocotb.test()
async def every_plane_and_kind(dut):
    bench = Bench(dut)
    single = 1 << np.arange(WIDTH - 1)
    corners = [WORD.low, WORD.high, 0, -1, *single, *(-1 - single)]
    random = bench.rng.integers(WORD.low, WORD.high + 1, 200 - len(corners))
    grid = np.meshgrid(np.concatenate([corners, random]), np.arange(CLEAR + 1), np.arange(4))
    words, planes, kinds = bench.rng.permutation(np.stack([g.ravel() for g in grid]), axis=1)
    drive = {"word": words & ((1 << WIDTH) - 1), "plane": 1 << planes, "kind": kinds}
    names = ["take_weight", "look_up", "subtract"]
    recording = await bench.play(drive, names)

    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    word = recording.signed("word", rows)
    seen = [recording.unsigned(name, rows) for name in ("plane", "kind")]
    take, table, subtract = bench.twin.process(word, *seen)
    got = [recording.unsigned(name, rows + bench.latency) for name in names]
    context = {"word": word, "plane": seen[0], "kind": seen[1]}
    bench.compare("take_weight", got[0], take, **context)
    bench.compare("look_up", got[1], table, **context)
    added = (take | table).astype(bool)
    context = {name: values[added] for name, values in context.items()}
    bench.compare("subtract", got[2][added], subtract[added], **context)
    bench.finish(at_least=30000)
