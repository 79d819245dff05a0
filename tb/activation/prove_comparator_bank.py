"""Proved properties of comparator_bank, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && (addr == 0))"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
