"""Proved properties of windowed, whatever comes on its stream.

What the network computes is proved of the network itself.
"""

from tb.sensing.prove_frame_window import window

# A case with another network, and with slots after the samples.
ALSO = ("chain-past",)


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
