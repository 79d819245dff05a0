"""table_graph, a network of learned functions as tables and sums, against its twin.

Sweeps: all recorded frames of the scene; every code of every sample that tables read; corner frames
(rails, alternating rails, zeros, one sensor at a rail); frames that drive each hidden sum to both
of its ends; random frames.
Drives: frames in every clock, with random gaps, with resets among them, and with one reset at each
clock of a frame's way through the design.
Checks: every output bit for bit in its clock, that no output comes in any other clock, the same of
index and margin of the largest output where the design has them, and that ``frame_error`` stays
low. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that), and that each
word of the tables behind a hidden sum has been read.
"""

import cocotb
import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench
from tb.common.case_library import TABLE_GRAPHS
from tb.common.stimulus import corner_frames
from tb.networks.tb_adder_graph import (
    check,
    random_frames,
    recorded,
    reset_at_every_clock,
    resets_among_frames,
)

__all__ = ["recorded", "reset_at_every_clock", "resets_among_frames"]

CASES = TABLE_GRAPHS


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
