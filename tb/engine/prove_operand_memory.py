"""Proved properties of operand_memory, whatever is written and read."""

from tb.common.properties import Property
from tb.common.watch import pipe


def properties(twin):
    late, width = twin.latency, twin.addr_width
    return [
        Property(
            name="what was written",
            sentence=f"The word that is read at each of {1 << width} addresses, {late} clock"
            f"{'s' * (late > 1)} later, is the one that was written there last, in a clock before "
            "that of the address.",
            states=(f"!there[{late - 1}] || !met_{late - 1} || word == kept_{late - 1}",),
            watch=f"""
                // Any one address, and the word that was written there last.
                (* anyconst *) reg [{width - 1}:0] place;
                reg known = 0;
                reg [17:0] kept;
                always @(posedge clk) if (write && write_addr == place) begin
                    known <= 1;
                    kept <= data;
                end
                wire met = known && read_addr == place;
            """
            + pipe("met", late, 1)
            + pipe("kept", late, 18, also=False),
            helps=(
                "!known || memory[place] == kept",
                *(("!there[0] || !met_0 || found == kept_0",) if late > 1 else ()),
            ),
            reached=(f"there[{late - 1}] && met_{late - 1}",),
            refuted_by=(
                (r"if \(write\)", "if (1)"),
                (r"memory\[read_addr\]", "memory[read_addr ^ 1]"),
                (r"memory\[write_addr\] <= data", "memory[write_addr >> 1] <= data"),
                (
                    r"found <= memory",
                    "if (write && write_addr == read_addr) found <= data; else found <= memory",
                ),
            ),
            clocks=late + 2,
            induction=late,
            arrays=True,
        ),
    ]
