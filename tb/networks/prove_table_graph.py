"""Proved properties of table_graph, whatever comes on its ports."""

from tb.common.properties import Property
from tb.common.watch import pipeline
from tb.networks.prove_adder_graph import winner

# A network that finds its largest output.
ALSO = ("argmax-tables",)


def properties(twin):
    broken = (
        (r"(delay0_taps\[0\]) <= in_valid", r"\1 <= (in_valid && !\1)"),
        (r"(delay0_taps\[0\]) <= 0;", ""),
    )
    return [
        pipeline(twin, broken),
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
