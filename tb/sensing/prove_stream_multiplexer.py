"""Proved properties of stream_multiplexer, whatever drives it."""

from tb.common.properties import Property
from tb.common.watch import pipeline


def properties(twin):
    width = twin.fmt.width
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && !result_valid)"),
                (r"rst == 1\) begin\s+out_last", "0) begin out_last"),
            ),
            last="in_last",
        ),
        Property(
            name="only the slot",
            sentence=f"Element {twin.slot} of each frame is the result that came last, and all "
            "other elements are those that came in.",
            states=("!out_valid || out_data == expected",),
            watch=f"""
                reg [31:0] place = 0;
                reg signed [{width - 1}:0] newest;
                reg signed [{width - 1}:0] expected;
                always @(posedge clk) begin
                    if (result_valid) newest <= result;
                    expected <= place == {twin.slot} ? newest : in_data;
                    if (in_valid) place <= in_last ? 0 : place == 32'hffffffff ? place : place + 1;
                    if (rst) place <= 0;
                end
            """,
            helps=(
                f"count == (place > {twin.slot + 1} ? {twin.slot + 1} : place)",
                "newest == held",
                "!out_valid || expected == out_data",
            ),
            # Both may be anything, but the same.
            assumes={
                "Before the first result, the held result and its copy in the proof are equal.": (
                    "after_reset || newest == held"
                )
            },
            reached=(f"out_valid && place == {twin.slot + 1}",),
            refuted_by=(
                (r"count == 2", "count == 1"),
                (r"count != 3", "1"),
                (r"if \(result_valid\)", "if (1)"),
            ),
        ),
    ]
