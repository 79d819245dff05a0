"""Proved properties of lane_round, for every sum and everything that is given in its place."""

from golden.engine.formats import DROPPED, SAMPLE_SHIFT
from golden.engine.operand_memory import WORD
from tb.common.properties import Property

# With ReLU, and of quantised networks.
ALSO = ("relu-lanes", "exact-lanes", "floor-lanes")


def behind(twin, word, where):
    """A word with what becomes 0 where the flags of ``where`` say so."""
    for name, mask in twin.zeros.items():
        word = f"({where}_{name} ? {word} & 18'h{mask & 0x3FFFF:05x} : {word})"
    return word


def properties(twin):
    low, high = WORD.low, WORD.high
    least = f"(relu ? 0 : {low})" if twin.rectifies else f"{low}"
    with_relu, relu = "", ()
    if twin.rectifies:
        with_relu = " With relu a sum below 0 becomes 0."
        relu = ((r"relu && ", ""), (r"&& \(!relu\)", ""))
    shown = f"cut < {least} ? {least} : cut > {high} ? {high} : cut"
    also = ""
    if twin.cut:
        unit, end = 1 << twin.cut, high + 1 - (1 << twin.cut)
        even = f"sum % 64'sd{unit << DROPPED} == 0 ? 64'sd{2 * unit} : " if twin.even else ""
        with_relu += f" The word is then a multiple of {unit} and at most {end}."
        with_relu += " Of two that are equally near it is the even one." if twin.even else ""
        shown = f"!relu ? ({shown}) : cut < 0 ? 0 : cut > {high} ? {end} : cut - cut % step"
        also = f", its lowest {twin.cut} where next_cut is"
        also += f", and bit {twin.cut} where next_even is" if twin.even else ""
        relu += ((r"low_now \|\| zero0_now", "low_now"),)
        even_faults = (r"rest == 0", "rest == 1"), (r" && \(!high\)", "")
        relu += even_faults if twin.even else ()
    states = ["!after_reset || $signed(word) == expected"]
    if twin.leads:
        given = f"the word is {1 << SAMPLE_SHIFT} times the sample. In the clock before, next_word "
        given += "is the same, except that its lowest 17 bits are still to become 0 where next_low "
        given += f"is high{also}."
        states.append(f"$signed({behind(twin, 'next_word', 'next')}) == now")
        name, value = "eightfold", f"$signed(sample) * 32'sd{1 << SAMPLE_SHIFT}"
        wrong = (r"wide << 3", "wide << 2")
    else:
        given = "the word is that of the first lane, whose lowest 17 bits are 0 where other_low is "
        given += f"high{also.replace('next', 'other')}."
        name, value = "passed", f"$signed({behind(twin, 'other', 'other')})"
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
                    : {shown};
                reg signed [31:0] expected;
                always @(posedge clk) expected <= now;
            """
            + (f"wire signed [63:0] step = {even}64'sd{unit};" if twin.cut else ""),
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
