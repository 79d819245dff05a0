"""Proved properties of table_graph, whatever comes on its ports."""

from tb.sign_off.properties import Property
from tb.sign_off.watch import pipeline


def properties(twin):
    broken = (
        (r"(delay0_taps\[0\]) <= in_valid", r"\1 <= (in_valid && !\1)"),
        (r"(delay0_taps\[0\]) <= 0;", ""),
    )
    return [
        pipeline(twin, broken),
        Property(
            name="frame_error",
            sentence="frame_error is never high.",
            states=("!frame_error",),
            reached=("out_valid",),
            refuted_by=((r"frame_error <= 1'b0", "frame_error <= in_valid"),),
            clocks=twin.latency + 2,
        ),
    ]
