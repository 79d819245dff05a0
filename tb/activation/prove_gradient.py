"""Proved properties of gradient, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"\.in_valid\(sum_valid\)", ".in_valid(addr_valid)"),
                (r"\.in_valid\(mag_valid\)", ".in_valid(mag_valid && !negative)"),
            ),
        ),
    ]
