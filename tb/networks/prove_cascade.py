"""What is proved of cascade, whatever comes on its stream.

Its outputs hang on the judges of all its parts, each later than the one before, which no induction
over few clocks covers: of them nothing is proved.
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
