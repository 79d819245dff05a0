"""cascade, networks one after the other, against its twin: the tests of tb/common/network.py."""

from tb.common import network, watch
from tb.common.case_library import cases

CASES = cases("cascades")

# These tests are those of every network with a stream.
corners_and_random = network.corners_and_random
recorded = network.recorded
reset_at_every_clock = network.reset_at_every_clock
resets_in_mid_frame = network.resets_in_mid_frame
wrong_lengths = network.wrong_lengths


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
