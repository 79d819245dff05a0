"""Proved properties of gradient_parallel, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"\.in_valid\(valid_0\)", ".in_valid(valid_0 && !negative_late)"),
                (r"\.in_valid\(mag_valid\)", ".in_valid(in_valid)"),
            ),
        ),
    ]
