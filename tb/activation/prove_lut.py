"""Proved properties of lut, whatever drives it."""

from tb.common.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"word_valid <= segment_valid", "word_valid <= mag_valid"),
                (r"rst == 1", "0"),
            ),
        ),
    ]
