"""Proved properties of pulse_density."""

from tb.common.properties import Property


def properties(twin):
    width, low = twin.fmt.width, -twin.fmt.low
    return [
        Property(
            name="as many ones as are asked for",
            sentence=f"The sum of all codes since a reset, each increased by {low}, is 2^{width} "
            "times the number of ones that were given, plus a remainder that is smaller than "
            f"2^{width}.",
            states=("asked_for == {ones + {31'b0, out_bit}, remainder}",),
            watch=f"""
                // Modulo 2^{32 + width}.
                reg [{31 + width}:0] asked_for = 0;
                reg [31:0] ones = 0;
                wire [{width - 1}:0] above_low = in_data + {low};
                always @(posedge clk) begin
                    asked_for <= rst ? 0 : asked_for + {{32'b0, above_low}};
                    ones <= rst ? 0 : ones + {{31'b0, out_bit}};
                end
            """,
            reached=("out_bit",),
            refuted_by=(
                (r"asked\[13\] = \(!in_data\[13\]\)", "asked[13] = in_data[13]"),
                (r"given <= total\[14\]", "given <= total[13]"),
            ),
        )
    ]
