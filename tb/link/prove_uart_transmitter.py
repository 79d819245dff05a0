"""Proved properties of uart_transmitter."""

from golden.link.uart_transmitter import BYTE_BITS
from tb.common.properties import Property


def properties(twin):
    bit, whole = twin.divisor, twin.interval
    return [
        Property(
            name="bits of a byte",
            sentence=f"From one clock after a byte is taken, tx is 0 for {bit} clocks, then each "
            f"bit of the byte for {bit} clocks, the lowest first, and then 1 for {bit} clocks. "
            "Without a byte, and after a reset, tx is 1. The next byte is taken in the last clock "
            "of the stop bit, or later.",
            states=(
                "tx == (age == IDLE || all_bits[age / BIT])",
                "in_ready == (age == IDLE || age == IDLE - 1)",
            ),
            watch=f"""
                localparam [15:0] BIT = {bit}, IDLE = {whole};
                // Clocks since the start bit began.
                reg [15:0] age = IDLE;
                reg [7:0] taken = 0;
                wire [{BYTE_BITS - 1}:0] all_bits = {{1'b1, taken, 1'b0}};
                wire [{2 * BYTE_BITS - 1}:0] moved = {{{{{BYTE_BITS}{{1'b1}}}}, all_bits}}
                    >> (age / BIT);
                always @(posedge clk) begin
                    if (in_valid && in_ready) taken <= in_data;
                    age <= in_valid && in_ready ? 0 : age == IDLE ? IDLE : age + 1;
                    if (rst) age <= IDLE;
                end
            """,
            helps=(
                "age <= IDLE",
                f"left == (age == IDLE ? 0 : {BYTE_BITS} - age / BIT)",
                "tick == (age == IDLE ? 0 : age % BIT)",
                f"line == (age == IDLE ? {(1 << BYTE_BITS) - 1} : moved[{BYTE_BITS - 1}:0])",
            ),
            reached=("age == IDLE - 1",),
            refuted_by=(
                (r"tick == \d+", "tick == 0"),
                (r"\(left == 1\) && ends", "(left == 1)"),
                (r"\{1'b1, in_data, 1'b0\}", "{1'b1, ~in_data, 1'b0}"),
                (r"\{1'b1, line", "{1'b0, line"),
            ),
            clocks=whole + 6,
        )
    ]
