"""operand_memory against its twin.

Sweeps: every address; then 4000 random writes and reads.
Drives: writes in two of three clocks, and reads of the written address in one of three. Without
``write`` the ports carry other data.
Checks: each word bit for bit, and the clock in which it appears; that a word which is read while it
is written has its old value.
Does not prove: what a word is before it is written.
"""

import cocotb
import numpy as np

from golden.common.border import State
from golden.engine.operand_memory import WORD
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import ENGINES

CASES = {name: ENGINES[name] for name in ("rails-engine", "deep-engine")}


@cocotb.test()
async def writes_and_reads(dut):
    bench = Bench(dut)
    rng, size = bench.rng, 1 << bench.twin.addr_width
    every = np.arange(size)
    count = 4000
    to = rng.integers(0, size, count)
    data = rng.integers(WORD.low, WORD.high + 1, size + count)
    data[::50], data[1::50] = WORD.low, WORD.high
    drive = {
        "write": np.concatenate([np.ones(size), rng.random(count) < 2 / 3]),
        "write_addr": np.concatenate([every, to]),
        "data": data,
        "read_addr": np.concatenate(
            [every, np.where(rng.random(count) < 1 / 3, to, rng.integers(0, size, count))]
        ),
    }
    recording = await bench.play(drive, ["word"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    names = ("write", "write_addr", "read_addr")
    write, write_addr, read_addr = (recording.unsigned(name, rows) for name in names)
    expected = bench.twin.process(write, write_addr, recording.signed("data", rows), read_addr)
    bench.visit(State("address written", range(size)), write_addr[write == 1])
    bench.visit(State("address read", range(size)), read_addr)
    # The words are unknown while every address is written for the first time.
    known = slice(size, None)
    got = recording.signed("word", rows[known] + bench.latency)
    bench.compare("word", got, expected[known], clock=rows[known], read_addr=read_addr[known])
    bench.finish(at_least=count - bench.latency)
