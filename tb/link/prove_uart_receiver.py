"""Proved properties of uart_receiver, whatever the line does."""

from tb.common.properties import Property
from tb.common.watch import since


def properties(twin):
    bit, half, stop = twin.divisor, twin.divisor // 2, twin.stop_clocks
    watch = f"""
        // The line one, two and three clocks ago; clocks to the next look at it, 0 for none, and
        // looks that were taken.
        reg one = 1, two = 1, three = 1;
        reg [7:0] ahead = 0;
        reg [3:0] looks = 0;
        always @(posedge clk) begin
            one <= rx;
            two <= one;
            three <= two;
            if (ahead == 0) begin
                ahead <= three && !two ? {half} : 0;
                looks <= 0;
            end else if (ahead == 1) begin
                ahead <= looks == 9 || (looks == 0 && two) ? 0 : {bit};
                looks <= looks + 1;
            end else ahead <= ahead - 1;
            if (rst) begin
                one <= 1;
                two <= 1;
                three <= 1;
                ahead <= 0;
            end
        end
    """
    ended = """
        reg good = 0, bad = 0;
        always @(posedge clk) begin
            good <= !rst && ahead == 1 && looks == 9 && two;
            bad <= !rst && ahead == 1 && looks == 9 && !two;
        end
    """
    helps = (
        f"ahead <= {bit}",
        "looks <= 9 || ahead == 0",
        f"ahead == 0 || looks != 0 || ahead <= {half}",
        "raised == one",
        "line == two",
        "earlier == three",
        "running == (ahead != 0)",
        f"ahead == 0 || tick == {bit} - ahead",
        "ahead == 0 || place == looks",
    )
    return [
        Property(
            name="looks",
            sentence=f"Where the line falls while no byte is under way, it is read {half} clocks "
            "later, and the byte ends there if the line is 1. If the line is 0, it is read every "
            f"{bit} clocks from then on, nine times, and the byte ends with the last reading. The "
            "line is read at no other time.",
            states=("running == (ahead != 0)", "sample == (ahead == 1)"),
            watch=watch,
            helps=helps,
            reached=("looks == 3",),
            refuted_by=(
                (r"earlier && \(!line\)", "earlier"),
                (r"earlier && \(!line\)", "(!line)"),
                (rf"tick <= {bit - half};", "tick <= 0;"),
                (rf"tick == {bit - 1}", f"tick == {bit - 2}"),
                (r"\(place == 0\) && line", "(place == 0) && 0"),
                (r"\(place == 0\) && line", "line"),
            ),
            clocks=stop + 8,
        ),
        Property(
            name="bytes",
            sentence="One clock after the last of these readings, at the stop bit, out_valid is "
            "high if the line was 1, and out_data are the eight bits before it, the lowest first. "
            "If the line was 0, line_error is high. Neither is high in any other clock.",
            states=("out_valid == good", "line_error == bad", "!good || out_data == bits"),
            watch=watch
            + ended
            + """
                reg [7:0] bits = 0;
                always @(posedge clk)
                    if (ahead == 1 && looks != 9) bits <= {two, bits[7:1]};
            """,
            helps=(
                *helps,
                "ahead == 0 || ((kept ^ bits) >> (looks > 8 ? 0 : 8 - looks)) == 0",
            ),
            reached=("out_valid", "line_error"),
            refuted_by=(
                (r"out_valid <= \(ends && line\)", "out_valid <= ends"),
                (r"place == 9", "place == 8"),
                (r"\{line, kept", "{earlier, kept"),
            ),
            clocks=stop + 6,
        ),
        Property(
            name="distance of bytes",
            sentence=f"From one byte to the next there are at least {twin.interval} clocks.",
            states=(f"!out_valid || apart >= {twin.interval}",),
            watch=watch
            + ended
            + since("apart", "out_valid", twin.interval)
            + f"""
                // Clocks of the byte under way so far.
                wire [7:0] age = ahead == 0 ? 0 : {half + 1} + {bit} * looks - ahead;
            """,
            helps=(
                *helps,
                "out_valid == good",
                f"apart <= {twin.interval}",
                "out_valid || apart >= age",
                "!out_valid || ahead == 0",
                f"!out_valid || apart >= {twin.interval}",
            ),
            reached=("out_valid",),
            refuted_by=((r"out_valid <= \(ends && line\)", "out_valid <= (sample && line)"),),
            clocks=stop + 6,
        ),
    ]
