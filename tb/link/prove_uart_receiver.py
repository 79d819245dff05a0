"""What is proved of uart_receiver."""

from tb.sign_off.properties import Property


def properties(twin):
    bit, half, stop = twin.divisor, twin.divisor // 2, twin.stop_clocks
    return [
        Property(
            name="bytes",
            sentence=f"Where the line falls while no byte is under way, and is 0 {half} clocks "
            f"later, it is read every {bit} clocks from then on: eight bits, the lowest first, and "
            "the stop bit. One clock after this out_valid is high if it is 1, and out_data are the "
            "bits; if it is 0 it is line_error. Neither is high in any other clock.",
            states=(
                "out_valid == good",
                "line_error == bad",
                "!good || out_data == bits",
            ),
            watch=f"""
                // The line one, two and three clocks ago; clocks to the next look at it, 0 for
                // none, and looks that were taken.
                reg one = 1, two = 1, three = 1, good = 0, bad = 0;
                reg [7:0] ahead = 0;
                reg [3:0] looks = 0;
                reg [7:0] bits = 0;
                always @(posedge clk) begin
                    one <= rx;
                    two <= one;
                    three <= two;
                    good <= ahead == 1 && looks == 9 && two;
                    bad <= ahead == 1 && looks == 9 && !two;
                    if (ahead == 1 && looks != 9) bits <= {{two, bits[7:1]}};
                    if (ahead == 0) begin
                        ahead <= three && !two ? {half} : 0;
                        looks <= 0;
                    end else if (ahead == 1) begin
                        ahead <= looks == 9 || (looks == 0 && two) ? 0 : {bit};
                        looks <= looks + 1;
                    end else ahead <= ahead - 1;
                    if (rst) begin
                        one <= 1; two <= 1; three <= 1;
                        good <= 0; bad <= 0; ahead <= 0;
                    end
                end
            """,
            helps=(
                f"ahead <= {bit}",
                "looks <= 9 || ahead == 0",
                "raised == one",
                "line == two",
                "earlier == three",
                "running == (ahead != 0)",
                f"ahead == 0 || tick == {bit} - ahead",
                "ahead == 0 || place == looks",
                "ahead == 0 || ((kept ^ bits) >> (looks > 8 ? 0 : 8 - looks)) == 0",
            ),
            reached=("out_valid", "line_error"),
            refuted_by=(
                (r"earlier && \(!line\)", "(!line)"),
                (rf"tick <= {bit - half};", "tick <= 0;"),
                (r"\(place == 0\) && line", "(place == 0) && 0"),
                (r"out_valid <= \(ends && line\)", "out_valid <= ends"),
                (r"\{line, kept", "{earlier, kept"),
            ),
            clocks=stop + 12,
        )
    ]
