"""windowed, a network that takes samples of past frames too, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail), which also are the past of others; frames that drive each hidden sum to both of its
ends; 100 random frames; frames that are too short or too long among good frames.
Drives: frames as close as the design takes them, with random gaps, closer than it takes them, with
resets in mid-frame, and with one reset at each clock of a frame, or at many clocks of a long frame;
after each reset the past begins anew.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that no output
comes in any other clock, in particular none before the past is complete. The bench also measures
the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

from tb.common.case_library import WINDOWS
from tb.common.network import (
    corners_and_random,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    wrong_lengths,
)

# The bench of frame_window covers delays of 64 frames, as it has no network to simulate.
CASES = {name: case for name, case in WINDOWS.items() if name != "long-past"}

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]
