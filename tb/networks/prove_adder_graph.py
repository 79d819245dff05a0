"""Proved properties of adder_graph, whatever comes on its ports."""

from tb.common.properties import Property
from tb.common.watch import ago, pipeline

# A network without tables that finds its largest output.
ALSO = ("exact-graph",)


def at_once(twin):
    """The property that all tables of a layer answer together."""
    flags, states = 0, []
    for groups in twin.groups:
        states += [f"r_valid_{flags + n} == r_valid_{flags}" for n in range(1, len(groups))]
        flags += len(groups)
    return Property(
        name="all nodes at once",
        sentence="The flags of all tables of activations are the same.",
        states=tuple(states),
        reached=("r_valid_0",),
        refuted_by=((r"(?s)(u_bipartite_pair_1 \(.*?\.in_valid\()q_valid", r"\1in_valid"),),
        clocks=twin.latency + 2,
        induction=twin.latency,
    )


def winner(twin):
    """The property that index and margin come for each frame."""
    late = twin.argmax.latency
    return Property(
        name="winner",
        sentence=f"winner_valid is exactly what out_valid was {late} clocks before, unless a reset "
        "came between.",
        states=(f"winner_valid == out_ago[{late - 1}]",),
        watch=ago("out_ago", "out_valid", late),
        reached=("winner_valid",),
        refuted_by=((r"winner_valid <= delay[^;]+", "winner_valid <= y_valid"),),
        clocks=twin.latency + late + 2,
        induction=late + 1,
    )


def properties(twin):
    tabled = any(twin.activations)
    # The last delay of the flag begins behind the tables, where there are any.
    broken = (
        (r"(delay1_taps\[0\]) <= r_valid_0", r"\1 <= (r_valid_0 || out_valid)"),
        (r"q_valid <= in_valid", "q_valid <= (in_valid && !q_valid)"),
        (r"(delay1_taps\[0\]) <= 0;", ""),
    )
    if not tabled:
        broken = (
            (r"(delay0_taps\[0\]) <= in_valid", r"\1 <= (in_valid && !\1)"),
            (r"(delay0_taps\[0\]) <= 0;", ""),
        )
    return [
        pipeline(twin, broken),
        *([at_once(twin)] if tabled else []),
        *([winner(twin)] if twin.argmax else []),
        Property(
            name="frame_error",
            sentence="frame_error is never high.",
            states=("!frame_error",),
            reached=("out_valid",),
            refuted_by=((r"frame_error <= 1'b0", "frame_error <= in_valid"),),
            clocks=twin.latency + 2,
        ),
    ]
