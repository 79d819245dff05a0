"""Proved properties of round_saturate, for every sum and sample."""

from golden.engine.formats import DROPPED, SAMPLE_SHIFT
from golden.engine.operand_memory import WORD
from tb.sign_off.properties import Property

# With ReLU.
ALSO = ("layers-engine",)


def properties(twin):
    low, high = WORD.low, WORD.high
    least = f"(relu ? 0 : {low})" if twin.rectifies else f"{low}"
    with_relu = "; with relu a sum below 0 is 0" if twin.rectifies else ""
    relu = (r"relu && acc", "acc"), (r"result = 0;", "result = 1;")
    return [
        Property(
            name="word",
            sentence=f"One clock later the word is the sum without its lowest {DROPPED} bits, or "
            f"the end of the word's range where that lies beyond it{with_relu}. Without run the "
            f"word is {1 << SAMPLE_SHIFT} times the sample.",
            states=("!after_reset || $signed(word) == expected",),
            watch=f"""
                wire signed [63:0] sum = $signed(acc);
                wire signed [63:0] cut = sum >>> {DROPPED};
                wire signed [31:0] eightfold = $signed(sample) * 32'sd{1 << SAMPLE_SHIFT};
                reg signed [31:0] expected;
                always @(posedge clk) begin
                    expected <= !run ? eightfold
                        : cut < {least} ? {least} : cut > {high} ? {high} : cut;
                end
            """,
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
                *(relu if twin.rectifies else ()),
            ),
            clocks=3,
            induction=2,
        ),
    ]
