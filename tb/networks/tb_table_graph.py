"""table_graph, a network of learned functions as tables and sums, against its twin.

The tests are those of adder_graph, with every code of every sample that tables read. Not each word
of the tables behind a hidden sum is read.
"""

import cocotb
import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common.at_once import check, random_frames
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.stimulus import corner_frames
from tb.networks.tb_adder_graph import (
    properties,
    recorded,
    reset_at_every_clock,
    resets_among_frames,
)

__all__ = ["properties", "recorded", "reset_at_every_clock", "resets_among_frames"]

CASES = cases("table-graphs")
# A network that finds its largest output.
PROVED = ("argmax-tables",)
COMPARED = PROVED
SHOWN_BY_FRAMES = ("constant_matrix",)


def every_code(bench):
    """Frames in which each sample has every code that tables can tell from others, in any order."""
    codes = np.arange(SIGNAL.low, SIGNAL.high + 1, 1 << SIGNAL.width - bench.twin.sample_bits)
    columns = [bench.rng.permutation(codes) for _ in range(bench.twin.inputs)]
    last = bench.rng.integers(0, codes[1] - codes[0], (len(codes), len(columns)))
    return np.stack(columns, axis=1) + last


@cocotb.test()
async def codes_and_corners(dut):
    """Play every code of each sample, corner frames, and frames that drive sums to their ends."""
    bench = Bench(dut)
    frames = np.concatenate(
        [
            every_code(bench),
            corner_frames(SIGNAL, bench.twin.inputs),
            bench.twin.extremes,
            random_frames(bench, 400),
        ]
    )
    for gap in (0.0, 0.4):
        await check(bench, frames, gap)
    bench.finish(at_least=400)
