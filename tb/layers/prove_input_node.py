"""Proved properties of input_node, for all samples and weights.

That no sum of a layer overflows is proved of input_integral, which knows the weights.
"""

from tb.common.properties import Property
from tb.common.watch import exact_sum, pipe

# A case in which products are truncated.
ALSO = ("wide-thesis",)


def properties(twin):
    sample, coeff = twin.in_fmt.width, twin.coeff_fmt.width
    width = sample + coeff
    half = (1 << twin.out_shift) >> 1
    low, high = twin.out_fmt.low, twin.out_fmt.high
    narrow = twin.acc_width - 2
    borders = (
        (r"kept > \d+", f"kept > {high + 1}"),
        (r"kept < \(-\d+\)", f"kept < ({low - 1})"),
        (r"acc \+ \d+", "acc + 0"),
    )
    return [
        Property(
            name="products",
            sentence="Each product is that of the sample and the weight two clocks before.",
            states=(
                "!there[0] || ($signed(sample) == x_0 && $signed(factor) == w_0)",
                "!there[1] || $signed(product) == expected",
            ),
            watch=f"""
                wire [{sample - 1}:0] x = in_data;
                wire [{coeff - 1}:0] w = weight;
            """
            + pipe("x", 1, sample)
            + pipe("w", 1, coeff, also=False)
            + f"""
                reg signed [{width - 1}:0] expected;
                always @(posedge clk) expected <= $signed(sample) * $signed(factor);
            """,
            reached=("there[1] && x_0 == -1 && w_0 == 3",),
            refuted_by=(
                (r"factor <= weight", "factor <= bias"),
                (r"product <= \(", "product <= 2 * ("),
                (r"sample <= in_data", "sample <= weight"),
            ),
            clocks=4,
        ),
        Property(
            name="no overflow",
            sentence=f"The sum of a bias and cut products loses no bit as long as its "
            f"{twin.acc_width} bits can hold it and all sums before it, whatever bias and products "
            "are.",
            states=("!begun || !fits || $signed(acc) == exact",),
            watch=exact_sum(
                twin.acc_width,
                opens="accumulate && preset",
                value="!accumulate ? exact : (preset ? first : exact) + added",
            )
            + f"""
                wire signed [63:0] first = $signed(bias) * 64'sd{1 << twin.bias_shift};
                wire signed [63:0] whole = $signed(product);
                wire signed [63:0] added = whole >>> {twin.product_shift};
            """,
            helps=(f"!begun || acc == exact[{twin.acc_width - 1}:0]",),
            free=("product",),
            reached=("begun && fits && exact > 100", "begun && !fits"),
            refuted_by=(
                (r"signed \[\d+:0\] total", f"signed [{narrow}:0] total"),
                (r"if \(accumulate\)", "if (1)"),
                (r"if \(preset\)", "if (0)"),
                (r"bias_word = bias", "bias_word = 0"),
            ),
            clocks=5,
        ),
        Property(
            name="result",
            sentence="The result is the sum before the last capture, rounded half up, or the end "
            "of the result's range where that lies beyond it.",
            states=("!captured || $signed(out_data) == expected",),
            watch=f"""
                wire signed [63:0] sum = $signed(acc);
                wire signed [63:0] rounded = (sum + 64'sd{half}) >>> {twin.out_shift};
                reg captured = 0;
                reg signed [31:0] expected;
                always @(posedge clk) if (capture) begin
                    captured <= 1;
                    expected <= rounded < {low} ? {low} : rounded > {high} ? {high} : rounded;
                end
            """,
            free=("acc",),
            reached=(
                f"captured && expected == {low} && !capture",
                f"captured && expected == {high}",
            ),
            refuted_by=(
                (r"if \(capture\)", "if (1)"),
                (r"out_data <= result", "out_data <= -result"),
                # A sum with as many bits as the result is neither rounded nor saturated.
                *(borders if twin.acc_width > twin.out_fmt.width else ()),
            ),
            clocks=3,
        ),
    ]
