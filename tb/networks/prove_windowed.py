"""What is proved of windowed, whatever comes on its stream.

What its network makes of a frame is proved of the network.
"""

from tb.sensing.prove_frame_window import window

# Another network, with slots behind the samples.
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
