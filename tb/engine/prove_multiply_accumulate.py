"""Proved properties of multiply_accumulate, for all operands and coefficients."""

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, WIDTH
from golden.engine.operand_memory import WORD
from tb.common.properties import Property
from tb.common.watch import exact_sum, pipe


def properties(twin):
    half = 1 << (DROPPED - 1)
    half_output = half << OUTPUT_SHIFT
    least, largest = WORD.low * WORD.high, WORD.low * WORD.low
    # A sum of so many products always fits, whatever they are.
    low, high = -1 << (twin.acc_width - 1), (1 << (twin.acc_width - 1)) - 1
    most = min((high - half_output) // largest, -low // -least)
    in_range = f"($signed(product) >= 64'sd0 + {least} && $signed(product) <= 64'sd{largest})"
    return [
        Property(
            name="products",
            sentence="Each product is that of the operand and the coefficient three clocks before. "
            "The coefficient is the program's weight or the half of the table's word that "
            "take_intercept names.",
            states=(
                "!there[1] || ($signed(factor_late) == taken_1 && $signed(coeff_late) == code_1)",
                "!there[2] || $signed(product) == expected",
            ),
            watch=f"""
                wire [{WIDTH - 1}:0] high = table_word >> {WIDTH}, low = table_word;
                wire [{WIDTH - 1}:0] code = weight | (take_intercept ? high : low);
                wire [{WIDTH - 1}:0] taken = operand;
            """
            + pipe("code", 2, WIDTH)
            + pipe("taken", 2, WIDTH, also=False)
            + f"""
                reg signed [{2 * WIDTH - 1}:0] expected;
                always @(posedge clk) expected <= $signed(factor_late) * $signed(coeff_late);
            """,
            reached=("there[2] && taken_1 == -1 && code_1 == 3",),
            refuted_by=(
                (r"weight \| chosen", "weight"),
                (r"table_word\[36-1:18\]", "table_word[17:0]"),
                (r"coeff_late <= coeff", "coeff_late <= bits"),
                (r"product <= \(", "product <= 2 * ("),
            ),
            clocks=4,
        ),
        Property(
            name="no overflow",
            sentence=f"The sum loses no bit as long as its {twin.acc_width} bits can hold it, "
            f"whatever its products are. They can hold every sum of up to {most} products.",
            states=(
                "!begun || !fits || $signed(acc) == exact",
                f"!begun || count > {most} || fits",
            ),
            watch=exact_sum(
                twin.acc_width,
                opens="opening || opening_output",
                value=f"(opening_output ? 64'sd{half_output} : opening ? 64'sd{half} : exact)"
                " + $signed(product)",
            ),
            assumes={f"A product of two codes lies between {least} and {largest}.": in_range},
            helps=(
                "!begun || acc == exact[" + f"{twin.acc_width - 1}:0]",
                "!begun || count != 0",
                *(
                    f"!begun || count != {n} || (exact >= {n} * 64'sd0 + {n * least} && exact "
                    f"<= 64'sd{n * largest + half_output})"
                    for n in range(1, most + 1)
                ),
            ),
            free=("product",),
            reached=(f"begun && count == {most}", "begun && !fits"),
            refuted_by=(
                (r"reg signed \[\d+:0\] total", f"reg signed [{twin.acc_width - 2}:0] total"),
                (r"base = 131072", "base = 8192"),
                (r"base = 8192", "base = 0"),
                (r"if \(opening_output\)", "if (opening_output && opening)"),
            ),
            clocks=most + 4,
        ),
    ]
