"""Proved properties of adder_graph, whatever comes on its ports."""

from tb.sign_off.properties import Property
from tb.sign_off.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"(delay1_taps\[0\]) <= r_valid_0", r"\1 <= (r_valid_0 || out_valid)"),
                (r"q_valid <= in_valid", "q_valid <= (in_valid && !q_valid)"),
                (r"(delay1_taps\[0\]) <= 0;", ""),
            ),
        ),
        Property(
            name="all nodes at once",
            sentence="The flags of all tables of activations are the same.",
            states=tuple(f"r_valid_{n} == r_valid_0" for n in range(1, len(twin.groups[0]))),
            reached=("r_valid_0",),
            refuted_by=((r"(?s)(u_bipartite_pair_1 \(.*?\.in_valid\()q_valid", r"\1in_valid"),),
            clocks=twin.latency + 2,
            induction=twin.latency,
        ),
        Property(
            name="frame_error",
            sentence="frame_error is never high.",
            states=("!frame_error",),
            reached=("out_valid",),
            refuted_by=((r"frame_error <= 1'b0", "frame_error <= q_valid"),),
            clocks=twin.latency + 2,
        ),
    ]
