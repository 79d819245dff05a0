"""Proved properties of serial_accumulate, for all coefficients and planes."""

from golden.engine.formats import WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.replay import CLEAR, HALF_OUTPUT_PLANE, HALF_PLANE
from tb.common.properties import Property
from tb.common.watch import exact_sum, pipe


def properties(twin):
    high = (1 << (twin.acc_width - 1)) - 1

    def reach(words, planes=WIDTH + 1):
        """The largest magnitude after the doubling of a plane, with so many words in each plane."""
        total = 0
        for plane in range(planes):
            total = 2 * (total + (plane > 0) * words * -WORD.low) + 1
        return total

    most = next(n for n in range(1, 99) if reach(n + 1, WIDTH) + (n + 1) * -WORD.low > high)
    return [
        Property(
            name="coefficients",
            sentence="The program's weight, where it counts, or the table's word is added, or its "
            "negative where it is subtracted. Half a unit of the result comes in when the sum is "
            "doubled in the plane of that half.",
            states=(
                "!there[1] || $signed(coeff) + $signed({1'b0, minus_late}) == change",
                f"!there[1] || (clears_late == plane_1[{CLEAR}] && doubles_late == first_1)",
                f"!there[1] || half_late == (of_output_1 ? plane_1[{HALF_OUTPUT_PLANE}] "
                f": plane_1[{HALF_PLANE}])",
            ),
            watch=pipe("weight", 1, WIDTH, also=False)
            + pipe("take_weight", 1, 1, also=False)
            + pipe("subtract", 1, 1, also=False)
            + pipe("plane", 2, CLEAR + 1, also=False)
            + pipe("first", 2, 1)
            + pipe("of_output", 2, 1, also=False)
            + f"""
                wire signed [{WIDTH - 1}:0] code = (take_weight_0 ? weight_0 : 0) | table_word;
                reg signed [31:0] change;
                always @(posedge clk) change <= subtract_0 ? -32'sd1 * code : code;
            """,
            helps=("!there[0] || minus == subtract_0",),
            reached=("there[1] && change == -5 && minus_late",),
            refuted_by=(
                (r"kept \| table_word", "kept"),
                (r"plane\[17\]", "plane[16]"),
                (r"plane\[13\]", "plane[12]"),
                (r"if \(take_weight\)", "if (1)"),
                (r"turned = \(~bits\)", "turned = -bits"),
            ),
            clocks=4,
        ),
        Property(
            name="no overflow",
            sentence=f"The sum loses no bit as long as its {twin.acc_width} bits can hold it, "
            f"whatever it is made of. They can hold that of every neuron with up to {most} words "
            "in each plane.",
            states=(
                "!begun || !fits || $signed(acc) == exact",
                f"!begun || words > {most} || planes > {WIDTH} || fits",
            ),
            watch=exact_sum(
                twin.acc_width,
                opens="clears_late",
                value="clears_late ? 64'sd0 : (doubles_late ? exact * 64'sd2 + rounds : exact) "
                "+ $signed(coeff) + one",
            )
            + """
                wire signed [63:0] rounds = half_late ? 64'sd1 : 64'sd0;
                wire signed [63:0] one = minus_late ? 64'sd1 : 64'sd0;
                // Doublings since the sum was cleared, and the most words between two of them.
                reg [7:0] planes = 0, here = 0, words = 0;
                wire [7:0] next = doubles_late ? 1 : here == 255 ? 255 : here + 1;
                always @(posedge clk) begin
                    planes <= clears_late ? 0 : planes == 255 ? 255 : planes + doubles_late;
                    here <= clears_late ? 0 : next;
                    words <= clears_late ? 0 : next > words ? next : words;
                end
            """,
            assumes={
                "The pass that clears is followed by one that doubles.": "planes != 0 || "
                "doubles_late || clears_late || !begun",
            },
            helps=(
                f"!begun || acc == exact[{twin.acc_width - 1}:0]",
                "here <= words",
                *(
                    f"!begun || words > {most} || planes != {n} "
                    f"|| (exact <= {end} && exact >= -{end})"
                    for n in range(WIDTH + 1)
                    for end in [f"(64'sd{reach(most, n)} + $signed({{1'b0, here}}) * 64'sd131072)"]
                ),
            ),
            free=("coeff",),
            reached=("begun && planes == 2 && exact < -5",),
            refuted_by=(
                (r"reg \[37:0\] total", "reg [18:0] total"),
                (r"right = \{base, minus_late\}", "right = {base, 1'b0}"),
                (r"total\[37-1:0\], half_late", "total[37-1:0], 1'b0"),
                (r"if \(clears_late\)", "if (0)"),
            ),
            clocks=6,
        ),
    ]
