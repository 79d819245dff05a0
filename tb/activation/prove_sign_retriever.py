"""Proved properties of sign_retriever, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && !in_negative)"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
