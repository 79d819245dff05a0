"""Proved properties of exp_interpolator, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"delay0_taps\[0\] <= in_valid", "delay0_taps[0] <= (in_valid || out_valid)"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
