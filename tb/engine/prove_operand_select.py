"""Proved properties of operand_select, for every word and kind."""

from golden.engine.formats import DROPPED
from golden.engine.graph import Kind
from tb.common.properties import Property
from tb.common.watch import pipe


def properties(twin):
    one, span = 1 << DROPPED, 1 << twin.segment_width
    late = twin.latency
    return [
        Property(
            name="operand",
            sentence=f"The operand comes {late} clocks later and is what its kind says: the word, "
            "the number one with the word's sign, the word's distance from the middle of a segment "
            f"of {span} codes, or the number one.",
            states=(f"!there[{late - 1}] || $signed(operand) == expected_{late - 1}",),
            watch=f"""
                wire signed [31:0] whole = $signed(word);
                wire signed [31:0] inside = whole & {span - 1};
                wire signed [31:0] expected = kind == {Kind.WORD:d} ? whole
                    : kind == {Kind.DISTANCE:d} ? inside - {span // 2}
                    : kind == {Kind.INTERCEPT:d} && whole < 0 ? -{one} : {one};
            """
            + pipe("expected", late, 32),
            reached=(f"there[{late - 1}] && expected_{late - 1} == -{span // 2}",),
            refuted_by=(
                (r"below = \(!word\[(\d+)\]\)", r"below = word[\1]"),
                (r"\(kind == 1\) && word\[17\]", "(kind == 1)"),
                (r"kind == 2", "kind == 3"),
                (r"chosen = 16384", "chosen = 16383"),
            ),
            clocks=late + 2,
            induction=late + 1,
        ),
    ]
