"""Proved properties of lane_accumulate, for all words, coefficients and sums."""

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, WIDTH
from golden.engine.graph import Kind
from golden.engine.operand_memory import WORD
from tb.common.properties import Property
from tb.common.watch import pipe

# It adds the sums of three lanes, and has no table.
ALSO = ("relu-lanes",)


def properties(twin):
    return [products(twin), sums(twin)]


def products(twin):
    one, span = 1 << DROPPED, 1 << twin.segment_width
    operand = f"kind % 2 ? {one} : whole"
    kinds, faults = "the word, or the number one where the kind is odd", ()
    if twin.segment_width:
        operand = (
            f"kind == {Kind.WORD:d} ? whole : kind == {Kind.DISTANCE:d} ? inside - {span // 2} : "
            f"kind == {Kind.INTERCEPT:d} && whole < 0 ? -{one} : {one}"
        )
        kinds = (
            "what its kind says: the word, the number one with the word's sign, the word's "
            f"distance from the middle of a segment of {span} codes, or the number one"
        )
        faults = ((r"below = \(!word\[(\d+)\]\)", r"below = word[\1]"),)
    return Property(
        name="products",
        sentence=f"Each product is that of the operand three clocks before and of the coefficient "
        f"two clocks before. The operand is {kinds}.",
        states=(
            "!there[1] || ($signed(factor_late) == taken_1 && $signed(coeff_late) == code_0)",
            "!there[2] || $signed(product) == expected",
        ),
        watch=f"""
            wire signed [31:0] whole = $signed(word);
            wire signed [31:0] inside = whole & {span - 1};
            wire signed [31:0] taken = {operand};
            wire signed [{WIDTH - 1}:0] code = $signed(coeff);
        """
        + pipe("taken", 2, 32)
        + pipe("code", 1, WIDTH, also=False)
        + f"""
            reg signed [{2 * WIDTH - 1}:0] expected;
            always @(posedge clk) expected <= $signed(factor_late) * $signed(coeff_late);
        """,
        reached=("there[1] && taken_1 == -1 && code_0 == 3",),
        refuted_by=(
            (r"coeff_late <= .*;", "coeff_late <= 0;"),
            (r"product <= \(", "product <= 2 * ("),
            *faults,
        ),
        clocks=4,
    )


def sums(twin):
    half = 1 << (DROPPED - 1)
    output = half << OUTPUT_SHIFT
    own, joined, of_output = (half, half, output) if twin.leads else (half, 0, 0)
    named = "$signed(product)"
    for n in range(twin.partners):
        named = f"gather_0[{n}] ? $signed(other_{n}) : {named}"
    other = ", or of another sum in its place, the last that gather names" if twin.partners else ""
    low, high = WORD.low << DROPPED, ((WORD.high + 1) << DROPPED) - 1
    faults = [
        (r"above != 0\)", "above != 1)"),
        (rf"above != {(1 << (twin.acc_width - DROPPED - WIDTH + 1)) - 1}", "above != 0"),
        (r"base <= start", "base <= 0"),
    ]
    if twin.partners:
        faults.append((r"takes <= \(gather != 0\)", "takes <= 0"))
    return Property(
        name="sums",
        sentence=f"Each sum is that of the product before{other}, and of the sum before, or of the "
        f"number with which it starts: {own} where the lane's own sum starts, {joined} where that "
        f"of all lanes starts, {of_output} if it is that of an output. high and low say whether it "
        "is above or below every word.",
        states=(
            "!there[2] || acc == expected",
            f"!there[2] || high == (whole > 64'sd{high})",
            f"!there[2] || low == (whole < -64'sd{-low})",
        ),
        watch="wire [2:0] opens_now = opens; wire signed [63:0] whole = $signed(acc);"
        + pipe("opens_now", 3, 3)
        + (
            f"""
            wire [{twin.partners - 1}:0] gather_now = gather;
            reg [{twin.partners - 1}:0] gather_0;
            always @(posedge clk) gather_0 <= gather_now;
            """
            if twin.partners
            else ""
        )
        + f"""
            wire signed [{twin.acc_width - 1}:0] begun = opens_now_1 == 1 ? {own}
                : opens_now_1 == 2 ? {joined} : opens_now_1 == 3 ? {of_output} : acc;
            wire signed [{twin.acc_width - 1}:0] summand = {named};
            reg signed [{twin.acc_width - 1}:0] expected;
            always @(posedge clk) expected <= begun + summand;
        """,
        free=("product",),
        reached=("there[2] && high", "there[2] && low"),
        refuted_by=tuple(faults),
        clocks=6,
        induction=4,
    )
