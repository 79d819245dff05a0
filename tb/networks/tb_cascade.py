"""cascade, networks one after the other, against its twin: the tests of tb/common/network.py."""

from tb.common import watch
from tb.common.case_library import cases
from tb.common.network import TESTS

CASES = cases("cascades")

recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock = TESTS


def properties(twin):
    """Nothing is proved of its outputs.

    They depend on the frame checks of all parts, each of which comes later than the one before, and
    no induction over few clocks covers that.
    """
    error, _ = watch.network(
        twin,
        "u_input_controller_0",
        wrong=(
            (r"&& \(!done\)", "&& (!in_last)"),
            (r"frame_error <= broken", "frame_error <= (broken && in_last)"),
        ),
        good=(),
    )
    return [error]
