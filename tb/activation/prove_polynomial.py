"""Proved properties of polynomial, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"result_valid <= delay2_taps\[\(1 - 1\)\]", "result_valid <= segment_valid"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
