"""The check that the benches of all memories use."""

import numpy as np

from golden.common.border import State
from tb.common.bench import RESET_CLOCKS, Bench


async def check_memory(bench: Bench, *more: np.ndarray):
    """Read every address, then random ones, then the addresses in ``more``.

    Each word must appear ``bench.latency`` clocks after its address.
    """
    size = 1 << bench.twin.addr_width
    addresses = np.concatenate([np.arange(size), bench.rng.integers(0, size, 200), *more])
    recording = await bench.play({"addr": addresses}, ["word"])
    rows = np.arange(RESET_CLOCKS, recording.clocks - bench.latency)
    seen = recording.unsigned("addr", rows)
    bench.visit(State("address", range(size)), seen)
    got = recording.unsigned("word", rows + bench.latency)
    bench.compare("word", got, bench.twin.process(seen), addr=seen)
    bench.finish(at_least=len(addresses) - bench.latency)
