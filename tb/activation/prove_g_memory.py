"""Proved properties of g_memory, at every address."""

from tb.common.watch import read_only


def properties(twin):
    return [
        read_only(
            twin,
            (
                (r"0: word = ", "0: word = 1 + "),
                (r"default: word = ", "default: word = 1 + "),
            ),
        ),
    ]
