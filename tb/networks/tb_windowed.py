"""windowed, a network that takes samples of past frames too: the tests of tb/common/network.py.

After each reset the past begins anew.
"""

from tb.common.case_library import cases
from tb.common.network import TESTS
from tb.sensing.window_proof import window

# The bench of frame_window covers delays of 64 frames, as it has no network to simulate.
CASES = cases("past", "chain-past", "few-past")
# A case with another network, and with slots after the samples.
PROVED = ("chain-past",)

recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock = TESTS


def properties(twin):
    return window(
        twin.frame_window,
        "u_frame_window_0.",
        f"u_{twin.network.entity}_0.in_",
        wrong=((r"\.frame_error\(frame_error\)", ".frame_error(broken)"),),
        lost=(
            (r"\.in_valid\(valid\)", ".in_valid(in_valid)"),
            (r"\.in_last\(last\)", ".in_last(in_last)"),
        ),
    )
