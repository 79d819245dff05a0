"""Proved properties of lane_memory, for every place, word and kind.

Of a memory that is written, the words are left to the bench, because z3 gives no answer within
minutes for so large a memory.
"""

from golden.engine.formats import WIDTH
from tb.common.properties import Property
from tb.common.watch import pipe, table

# With weights alone, with smaller segments, with several blocks, and with words that are written.
PROVED = ("relu-lanes", "layers-lanes", "tables-lanes", "bell-lanes", "tables-lanes-reload")


def properties(twin):
    width, segments, half = twin.addr_width, twin.segments, 1 << twin.half_width
    here, looked, piece = "place", "", ""
    if twin.table:
        piece = f"""
            wire signed [31:0] whole = $signed(word);
            wire [31:0] piece = (whole < 0 ? -32'sd1 - whole : whole) / {1 << twin.segment_width};
        """
        where = f"piece % {segments}"
        looked = (
            " With kind 1 and 2 it is the intercept and the slope of the word's segment, counted "
            "from 0 up and from -1 down."
        )
        if twin.blocks > 1:
            piece += f"""
                wire [31:0] named = (place % {2 * twin.blocks}) / 2;
                wire [31:0] block = named % 2 == 0 && place % 2 == 1 && whole < 0
                    ? named + 1 : named;
            """
            where = f"block * {segments} + {where}"
            looked += (
                " Half the place names the block, and an odd place the next one for a word below 0."
            )
        slopes = segments * twin.blocks
        here = f"kind == 1 ? {where} : kind == 2 ? {slopes} + {where} : {half} + place"
        faults = (
            (r"if \(word\[17\]\)", "if (word[16])"),
            (r"looked = \{kind\[1\]", "looked = {kind[0]"),
            (r"looks = .*;", "looks = (kind == 1);"),
        )
        if twin.blocks > 1:
            faults += ((r"chosen = .*;", "chosen = place[1];"),)
    else:
        faults = ((r"address = place", "address = 0"),)
    if twin.written:
        return [written(f"{piece} wire [{width}:0] here = {here};", looked, faults)]
    return [
        Property(
            name="coefficient",
            sentence="One clock later the coefficient is the weight at the place, as in the twin."
            + looked,
            states=("!there[0] || coeff == contents(here_0)",),
            watch=f"{piece} wire [{width}:0] here = {here};"
            + pipe("here", 1, width + 1)
            + table("contents", twin.contents, WIDTH),
            reached=("there[0] && here_0 == 1",),
            refuted_by=((r"(memory\[1\] <= \S+);", r"\1 ^ 1;"), *faults),
            clocks=3,
            induction=2,
        )
    ]


def written(here, looked, faults):
    """The address of a memory that is written; what is read there is left to the bench."""
    return Property(
        name="address",
        sentence="The word that is read is the one at the place." + looked,
        states=("address == here",),
        watch=here,
        reached=("here == 1",),
        refuted_by=faults,
        clocks=3,
        induction=2,
    )
