"""The check that the memories share."""

from __future__ import annotations

import numpy as np

from tb.common.bench import RESET_CLOCKS, Bench


async def check_memory(bench: Bench):
    """Read every address, then random ones, and compare each word in the same clock."""
    size = 1 << bench.twin.addr_width
    addresses = np.concatenate([np.arange(size), bench.rng.integers(0, size, 200)])
    recording = await bench.play({"addr": addresses}, ["word"])
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    seen = recording.unsigned("addr", rows)
    bench.compare("word", recording.unsigned("word", rows), bench.twin.process(seen), addr=seen)
    bench.finish(at_least=size + 200)
