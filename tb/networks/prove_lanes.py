"""Proved properties of lanes: frames, outputs, the program counter and the operands' addresses.

The proofs do not cover what the data paths compute. A program has no branches, so its clocks are
the same for every frame.
"""

from tb.networks.prove_engine import built_in

# It has ReLU, eight lanes and no table.
ALSO = ("relu-lanes",)


def properties(twin):
    return built_in(twin, "samples")
