"""Proved properties of table_address, for every sum."""

from tb.sign_off.properties import Property


def properties(twin):
    span, last = 1 << twin.segment_width, twin.segments - 1
    kept = f"piece > {last} ? {last} : piece" if twin.beyond else f"piece % {1 << twin.addr_width}"
    return [
        Property(
            name="segment",
            sentence=f"One clock later the address is the segment of {span} codes in which q lies, "
            "counted from 0 up and from -1 down"
            + (f". Beyond the last segment it is {last}." if twin.beyond else "."),
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
                (r"addr <= \d+", "addr <= 0"),
                (r"top > 4", "top > 5"),
            ),
            clocks=3,
            induction=2,
        ),
    ]
