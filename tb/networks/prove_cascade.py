"""Proved properties of cascade, whatever comes on its stream.

Nothing is proved of its outputs. They depend on the frame checks of all parts, each of which comes
later than the one before, and no induction over few clocks covers that.
"""

from tb.common.watch import network


def properties(twin):
    error, _ = network(
        twin,
        "u_input_controller_0",
        wrong=(
            (r"&& \(!done\)", "&& (!in_last)"),
            (r"frame_error <= broken", "frame_error <= (broken && in_last)"),
        ),
        good=(),
    )
    return [error]
