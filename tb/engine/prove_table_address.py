"""Proved properties of table_address, for every sum."""

from tb.common.properties import Property

# With several blocks of the table; the second case has two, of few segments.
ALSO = ("tables-serial", "bell-serial")


def properties(twin):
    span, last = 1 << twin.segment_width, twin.segments - 1
    words = 1 << (twin.addr_width - twin.block_width)
    kept = f"piece > {last} ? {last} : piece" if twin.beyond else f"piece % {words}"
    ends = f". Beyond the last segment it is {last}." if twin.beyond else "."
    broken = ((r"addr <= \d+", "addr <= 0"), (r"top > 4", "top > 5"))
    if twin.blocks > 1:
        kept = f"{kept} + {words} * (base / 2 | (whole < 0 ? base % 2 : 0))"
        ends = (
            f", in the block of {words} words that base names. Where the lowest bit of base is "
            "set, a negative q has the other block of a pair."
        )
        broken = ((r"base\[1\] \|\|", "base[1] &&"), (r"base\[0\] &&", "base[0] ||"))
    return [
        Property(
            name="segment",
            sentence=f"One clock later the address is the segment of {span} codes in which q lies, "
            f"counted from 0 up and from -1 down{ends}",
            states=("!after_reset || addr == expected",),
            watch=f"""
                wire signed [31:0] whole = $signed(q);
                wire [31:0] piece = (whole < 0 ? -32'sd1 - whole : whole) / {span};
                reg [31:0] expected;
                always @(posedge clk) expected <= {kept};
            """,
            reached=(f"after_reset && expected == {last}", "after_reset && expected == 0"),
            refuted_by=(
                (r"if \(q\[17\]\)", "if (q[16])"),
                *broken,
            ),
            clocks=3,
            induction=2,
        ),
    ]
