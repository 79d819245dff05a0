"""Proved properties of exp_memory, at every address."""

from tb.common.watch import read_only


def properties(twin):
    return [
        read_only(
            twin,
            (
                (r"0: word <= ", "0: word <= 1 + "),
                (r"512: word <= ", "512: word <= 1 + "),
            ),
        ),
    ]
