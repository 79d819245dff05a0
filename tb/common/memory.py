"""The test of a memory whose word comes in the clock of its address."""

import numpy as np

from golden.common.border import State
from tb.common.bench import RESET_CLOCKS, Bench, test_named
from tb.common.recorded_frames import recorded_inputs


def memory_test(module: str):
    """The test ``every_address`` of a bench, by its name."""

    @test_named(module, "every_address")
    async def every_address(dut):
        """Read every address, then random ones, then those of recorded frames.

        Each word must appear in the clock of its address.
        """
        bench = Bench(dut)
        size = 1 << bench.twin.addr_width
        random = bench.rng.integers(0, size, 200)
        addresses = np.concatenate([np.arange(size), random, *recorded_inputs(bench)])
        recording = await bench.play({"addr": addresses}, ["word"])
        rows = np.arange(RESET_CLOCKS, recording.clocks)
        seen = recording.unsigned("addr", rows)
        bench.visit(State("address", range(size)), seen)
        bench.compare("word", recording.unsigned("word", rows), bench.twin.process(seen), addr=seen)
        bench.finish(at_least=len(addresses))

    return every_address
