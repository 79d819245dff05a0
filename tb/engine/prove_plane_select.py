"""Proved properties of plane_select, for every word, plane and kind."""

from golden.engine.graph import Kind
from golden.engine.replay import SIGN
from tb.common.properties import Property


def properties(twin):
    middle = 1 << (twin.segment_width - 1)
    within, sign = 2 * middle - 1, 1 << SIGN
    states = ("take_weight == take", "look_up == looked", "!(take || looked) || subtract == minus")
    return [
        Property(
            name="what is added",
            sentence="For each kind of operand, the bit in the plane says whether a coefficient "
            "counts, the program's or the table's. Where one counts, plane and sign say whether it "
            "is subtracted. Both are told one clock later.",
            states=tuple(f"!after_reset || ({text})" for text in states),
            assumes={
                "Exactly one bit of plane is set.": "plane != 0 && (plane & (plane - 19'd1)) == 0"
            },
            watch=f"""
                wire [31:0] number = {{14'b0, word}}, planes = {{13'b0, plane}};
                wire is_word = kind == {Kind.WORD:d}, is_one = kind == {Kind.ONE:d};
                wire is_intercept = kind == {Kind.INTERCEPT:d};
                wire is_distance = kind == {Kind.DISTANCE:d};
                // The highest bit of a distance inverted is its sign.
                wire has = (number & planes & 32'h3ffff) != 0;
                wire has_distance = ((number ^ {middle}) & planes & {within}) != 0;
                reg take, looked, minus;
                always @(posedge clk) begin
                    take <= is_one || is_word && has;
                    looked <= is_intercept || is_distance && has_distance;
                    minus <= planes == {sign} || is_intercept && $signed(word) < 0
                        || is_distance && planes == {middle};
                end
            """,
            reached=("after_reset && take && minus", "after_reset && looked && !minus"),
            refuted_by=(
                (r"late == 2\) && \(low != in_middle\)", "late == 2) && low"),
                (r"in_sign <= plane\[17\]", "in_sign <= plane[16]"),
                (r"late == 1\) && negative", "late == 1)"),
                (r"\(high \|\| low\)", "high"),
                (r"late == 3", "late == 2"),
            ),
            clocks=3,
            induction=2,
        ),
    ]
