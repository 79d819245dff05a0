"""multiple, networks side by side, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); frames that drive each hidden sum to both of its ends; 100 random frames; of many random
frames, those with the least and the largest output of each network; frames that are too short or
too long among good frames.
Drives: frames as close as the design takes them, with random gaps, closer than it takes them, with
resets in mid-frame, and with one reset at each clock of a frame.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that no output
comes in any other clock. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

import cocotb
import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench
from tb.common.case_library import MULTIPLES
from tb.common.network import (
    check,
    corners_and_random,
    pauses,
    random_elements,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    whole_frames,
    wrong_lengths,
)

CASES = MULTIPLES

# How many frames are searched for the least and the largest outputs, and how many of each are
# played.
MANY, ENDS = 1 << 16, 4

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]


@cocotb.test()
async def ends_of_outputs(dut):
    """Play the least and the largest outputs, so that each output changes its sign if it can."""
    bench = Bench(dut)
    frames = random_elements(bench, MANY * bench.twin.inputs).reshape(MANY, -1)
    at_rail = bench.rng.random(frames.shape) < 0.5
    frames[at_rail] = bench.rng.choice([SIGNAL.low, SIGNAL.high], at_rail.sum())
    order = np.argsort(bench.twin.process(frames), axis=0, kind="stable")
    ends = frames[np.concatenate([order[:ENDS], order[-ENDS:]]).ravel()]
    elements, last = whole_frames(bench, ends)
    await check(bench, elements, last, gap=0.0, pause=pauses(bench, last, closest=True))
    bench.finish(at_least=len(ends) * bench.twin.outputs)
