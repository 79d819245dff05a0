"""What is proved of cascade, whatever comes on its stream.

Nothing is proved of its outputs: they depend on the judges of all its parts, each later than the
one before, and no induction over few clocks covers these.
"""

from tb.sign_off.watch import network


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
