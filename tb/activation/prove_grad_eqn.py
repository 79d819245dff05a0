"""Proved properties of grad_eqn, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"delay0_taps\[0\] <= in_valid", "delay0_taps[0] <= (in_valid || delay0_taps[0])"),
                (r"out_valid <= delay0_taps\[\(2 - 1\)\]", "out_valid <= delay0_taps[0]"),
                (r"delay0_taps\[1\] <= 0;", ""),
            ),
        ),
    ]
