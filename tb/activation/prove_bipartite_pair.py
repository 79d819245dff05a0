"""Proved properties of bipartite_pair, whatever drives it."""

from tb.activation.prove_bipartite import EARLY_SIGN, LATE, sign
from tb.common.watch import pipeline

# Only the sign of the second node is wrong.
SECOND = tuple(part.replace(r"(\w+)negative_late", "(node1_)negative_late") for part in EARLY_SIGN)


def properties(twin):
    return [
        pipeline(twin, LATE),
        sign(twin.activation, "_0"),
        sign(twin.activation, "_1", SECOND),
    ]
