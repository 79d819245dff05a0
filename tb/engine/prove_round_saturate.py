"""Proved properties of round_saturate, for every sum and sample."""

from golden.engine.formats import DROPPED, SAMPLE_SHIFT
from golden.engine.operand_memory import WORD
from tb.common.properties import Property

# With ReLU, and of quantised networks.
ALSO = ("layers-serial", "exact-serial", "floor-serial")


def properties(twin):
    low, high = WORD.low, WORD.high
    least = f"(relu ? 0 : {low})" if twin.rectifies else f"{low}"
    with_relu, relu = "", ()
    if twin.rectifies:
        with_relu = " With relu a sum below 0 becomes 0."
        relu = ((r"if \(\(!relu\)\)", "if (0)"), (r"stored = 0;", "stored = 1;"))
    shown = f"cut < {least} ? {least} : cut > {high} ? {high} : cut"
    if twin.cut:
        unit, end = 1 << twin.cut, high + 1 - (1 << twin.cut)
        even = f"sum % 64'sd{unit << DROPPED} == 0 ? 64'sd{2 * unit} : " if twin.even else ""
        with_relu += f" The word is then a multiple of {unit} and at most {end}."
        with_relu += " Of two that are equally near it is the even one." if twin.even else ""
        shown = f"!relu ? ({shown}) : cut < 0 ? 0 : cut > {high} ? {end} : cut - cut % step"
        relu += ((rf"wide << {twin.cut}\)", f"wide << {twin.cut - 1})"),)
        even_faults = (r"below != 0", "below == 0"), (r"beyond \|\| ", "")
        relu += even_faults if twin.even else ()
    return [
        Property(
            name="word",
            sentence=f"One clock later the word is the sum without its lowest {DROPPED} bits, or "
            f"the end of the word's range where that lies beyond it.{with_relu} Without run the "
            f"word is {1 << SAMPLE_SHIFT} times the sample.",
            states=("!after_reset || $signed(word) == expected",),
            watch=f"""
                wire signed [63:0] sum = $signed(acc);
                wire signed [63:0] cut = sum >>> {DROPPED};
                wire signed [31:0] eightfold = $signed(sample) * 32'sd{1 << SAMPLE_SHIFT};
                reg signed [31:0] expected;
                always @(posedge clk) begin
                    expected <= !run ? eightfold
                        : {shown};
                end
            """
            + (f"wire signed [63:0] step = {even}64'sd{unit};" if twin.cut else ""),
            reached=(
                f"after_reset && expected == {low}",
                f"after_reset && expected == {high}",
            ),
            refuted_by=(
                (r"above != 0\)", "above != 1)"),
                (r"above != 127", "above != 126"),
                (r"result = 131071", "result = 131070"),
                (r"wide << 3", "wide << 2"),
                (r"if \(run\)", "if (1)"),
                *relu,
            ),
            clocks=3,
            induction=2,
        ),
    ]
