"""hybrid, the whole folded network, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); frames that drive each hidden sum to both of its ends; 100 random frames; frames that
are too short or too long among good frames.
Drives: frames as close as the design takes them, with random gaps, closer than it takes them, with
resets in mid-frame, and with one reset at each clock of a frame.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that no output
comes in any other clock. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

from tb.common.case_library import FOLDED, PRECISE, both_precisions
from tb.common.network import (
    corners_and_random,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    wrong_lengths,
)

CASES = {
    **FOLDED,
    **PRECISE,
    **both_precisions("gradient_parallel"),
    **both_precisions("lut"),
    **both_precisions("pade"),
    **both_precisions("polynomial"),
}

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]
