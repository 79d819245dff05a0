"""Proved properties of abs_unit, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid || out_valid)"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
