"""Proved properties of ramp, whatever drives it."""

from tb.common.properties import Property
from tb.common.watch import pipeline


def properties(twin):
    last = twin.points - 1
    return [
        pipeline(
            twin,
            (
                (r"out_valid <= in_valid", "out_valid <= (in_valid && !out_last)"),
                (r"rst == 1\) begin\s+out_valid <= 0", "0) begin"),
            ),
        ),
        Property(
            name="position after position",
            sentence=f"The positions come in order, from the first to the last of {twin.points}, "
            "and then from the first again. out_last comes with the last one. No position leaves "
            "its format: the accumulator never overflows.",
            states=(
                "!out_valid || whole_position == $signed(out_data)",
                f"!out_valid || out_last == (position == {last})",
            ),
            watch=f"""
                reg [15:0] next_position = 0;
                reg [15:0] position = 0;
                always @(posedge clk) begin
                    if (in_valid) begin
                        position <= next_position;
                        next_position <= next_position == {last} ? 0 : next_position + 1;
                    end
                    if (rst) next_position <= 0;
                end
                wire signed [45:0] whole = 46'sd{twin.acc_low + (1 << 44)} - 46'sd{1 << 44}
                    + $signed({{30'b0, position}}) * 46'sd{twin.step};
                wire signed [{31 + twin.fmt.width}:0] whole_position = whole >>> {twin.guard};
            """,
            helps=(
                f"next_position <= {last}",
                *(
                    f"next_position != {n} || acc == {twin.acc_low + n * twin.step}"
                    for n in range(twin.points)
                ),
            ),
            reached=("out_valid && out_last",),
            refuted_by=(
                (r"\(acc == (\d+)\)\) begin", r"(acc == (\1 - 1))) begin"),
                (r"rst == 1\) begin\s+acc", "0) begin acc"),
                (r"out_last <= \(acc == \d+\)", "out_last <= 0"),
            ),
        ),
    ]
