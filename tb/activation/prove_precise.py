"""Proved properties of precise, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"sum_valid <= delay1_taps\[\(4 - 1\)\]", "sum_valid <= delay1_taps[2]"),
                (r"delay1_taps\[2\] <= 0;", ""),
            ),
        ),
    ]
