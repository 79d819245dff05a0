"""Proved properties of lane_round, for every sum and everything that is given in its place."""

from golden.engine.formats import DROPPED, SAMPLE_SHIFT
from golden.engine.operand_memory import WORD
from tb.sign_off.properties import Property

# With ReLU.
ALSO = ("relu-lanes",)


def properties(twin):
    low, high = WORD.low, WORD.high
    least = f"(relu ? 0 : {low})" if twin.rectifies else f"{low}"
    with_relu, relu = "", ()
    if twin.rectifies:
        with_relu = " With relu a sum below 0 becomes 0."
        relu = ((r"relu && ", ""), (r"&& \(!relu\)", ""))
    states = ["!after_reset || $signed(word) == expected"]
    if twin.leads:
        given = f"the word is {1 << SAMPLE_SHIFT} times the sample. In the clock before, next_word "
        given += "is the same, except that its lowest 17 bits are still to become 0 where next_low "
        given += "is high."
        states.append("$signed(next_low ? next_word & 18'h20000 : next_word) == now")
        name, value = "eightfold", f"$signed(sample) * 32'sd{1 << SAMPLE_SHIFT}"
        wrong = (r"wide << 3", "wide << 2")
    else:
        given = "the word is that of the first lane, whose lowest 17 bits are 0 where other_low is "
        given += "high."
        name, value = "passed", "$signed(other_low ? other & 18'h20000 : other)"
        wrong = (r"low_now = other_low", "low_now = 0")
    return [
        Property(
            name="word",
            sentence=f"One clock later the word is the sum without its lowest {DROPPED} bits, or "
            f"the end of the word's range where that lies beyond it.{with_relu} Without own "
            f"{given}",
            states=tuple(states),
            watch=f"""
                wire signed [63:0] sum = $signed(acc);
                wire signed [63:0] cut = sum >>> {DROPPED};
                wire signed [31:0] {name} = {value};
                wire signed [31:0] now = !own ? {name}
                    : cut < {least} ? {least} : cut > {high} ? {high} : cut;
                reg signed [31:0] expected;
                always @(posedge clk) expected <= now;
            """,
            assumes={
                "high and low say whether the sum is above or below every word.": "high == (cut > "
                f"{high}) && low == (cut < {low})"
            },
            reached=(
                f"after_reset && expected == {low}",
                f"after_reset && expected == {high}",
            ),
            refuted_by=(
                (r"kept = 131071", "kept = 131070"),
                wrong,
                (r"if \(low_now\)", "if (0)"),
                *relu,
            ),
            clocks=3,
            induction=2,
        ),
    ]
