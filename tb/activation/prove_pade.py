"""Proved properties of pade, whatever drives it."""

from tb.common.properties import Property
from tb.common.watch import ago


def properties(twin):
    late, least = twin.latency, twin.interval
    return [
        Property(
            name="one for each",
            sentence=f"An in_valid that no other follows within {least - 1} clocks yields one "
            f"out_valid {late} clocks later, unless a reset came between, and nothing else does.",
            states=(f"out_valid == (valid_ago[{late - 1}] && !crowded[{late - 1}])",),
            watch=ago("valid_ago", "in_valid", late)
            + f"""
                // Which of them another follows too early.
                reg [{late - 1}:0] crowded = 0;
                wire [{late - 1}:0] early = in_valid ? {(1 << (least - 1)) - 1} : 0;
                always @(posedge clk) crowded <= rst ? 0 : {{crowded | early, 1'b0}};
            """,
            reached=("out_valid",),
            refuted_by=(
                (r"remaining <= \(3 - 1\)", "remaining <= 3"),
                (r"active && \(remaining == 0\)", "(remaining == 0)"),
                (r"result_valid <= ready", "result_valid <= (ready || start)"),
            ),
            clocks=late + 4,
            induction=late + 3,
        ),
    ]
