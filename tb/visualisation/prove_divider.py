"""Proved properties of divider, whatever drives it."""

from tb.common.properties import Property


def properties(twin):
    late = twin.latency
    age = """
        // Clocks since the one after the last in_valid; 255 where a reset came since.
        reg begun = 0;
        reg [7:0] age = 255;
        always @(posedge clk) begin
            begun <= !rst && in_valid;
            age <= rst ? 255 : begun ? 0 : age == 255 ? 255 : age + 1;
        end
    """
    helps = (
        "load == begun",
        f"remaining == (age < {late - 2} ? {late - 2} - age : 0)",
    )
    return [
        Property(
            name="cause",
            sentence=f"out_valid is high {late} clocks after an in_valid that is not followed by "
            f"another one within {late - 2} clocks or by a reset, and in no other clock.",
            states=(f"out_valid == (age == {late - 2})",),
            watch=age,
            helps=helps,
            reached=("out_valid", "out_valid && begun"),
            refuted_by=(
                (r"remaining <= 17", "remaining <= 16"),
                (r"&& \(!load\)\)", ")"),
                (r"remaining <= \(remaining - 1\)", "remaining <= (remaining - 2)"),
            ),
            clocks=late + 6,
        ),
        Property(
            name="no overflow",
            sentence="While digits are found, the remainder is below the divisor, and their "
            "difference keeps every bit, so that no step loses a bit. The numerator has room for "
            "every distance.",
            states=(
                "remaining == 0 || load || remainder < divisor",
                "whole_trial == $signed(trial)",
                "whole_product == product",
            ),
            watch=age
            + f"""
                wire signed [63:0] whole_trial = $signed({{32'b0, shifted}})
                    - $signed({{32'b0, divisor}});
                wire [63:0] whole_product = in_distance * 64'd{twin.gain};
            """,
            helps=(*helps, "remaining == 0 || load || divisor != 0"),
            reached=("remaining == 1",),
            refuted_by=(
                (r"if \(fits\)", "if (!fits)"),
                (r"divisor <= 1;", "divisor <= 0;"),
                (r"wire \[16:0\] product", "wire [15:0] product"),
            ),
            clocks=late + 2,
        ),
    ]
