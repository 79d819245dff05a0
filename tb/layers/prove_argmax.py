"""Proved properties of argmax, whatever drives it."""

from tb.common.properties import Property


def properties(twin):
    outputs, width = twin.outputs, twin.fmt.width
    most = outputs - 1
    return [
        Property(
            name="winner",
            sentence="out_valid is high one clock after each in_last that comes with in_valid and "
            f"without rst, and at no other time. After a frame of 2 to {outputs} outputs out_index "
            "is then the number of its largest output, the first of equal ones, and out_margin the "
            "difference between this output and the largest of the others.",
            states=(
                "out_valid == was_last",
                f"!(out_valid && seen >= 2 && seen <= {outputs}) || out_index == at",
                f"!(out_valid && seen >= 2 && seen <= {outputs}) || out_margin == lead",
            ),
            watch=f"""
                // Outputs of this frame so far, and those of which the registers below know.
                reg [15:0] place = 0, seen = 0, at = 0;
                reg signed [{width - 1}:0] top, second;
                wire [{width}:0] lead = top - second;
                reg was_last = 0;
                always @(posedge clk) was_last <= !rst && in_valid && in_last;
                always @(posedge clk) begin
                    if (after_reset && in_valid) begin
                        place <= in_last ? 0 : place == 99 ? 99 : place + 1;
                        seen <= place + 1;
                        if (place == 0 || in_data > top) begin
                            top <= in_data;
                            second <= top;
                            at <= place;
                        end else if (place == 1 || in_data > second) second <= in_data;
                    end
                    if (rst) place <= 0;
                end
            """,
            helps=(
                "place <= 99",
                f"count == (place > {most} ? {most} : place)",
                "place == 0 || place == seen || (place == 99 && seen == 100)",
                "seen == 0 || largest == top",
                f"seen == 0 || out_index == (at > {most} ? {most} : at)",
                "seen == 0 || at < seen",
                "seen < 2 || second <= top",
                f"seen == 0 || out_margin == (seen == 1 ? {(1 << width) - 1} : lead)",
            ),
            reached=(f"out_valid && seen == {outputs} && out_index == {most}",),
            refuted_by=(
                (r"low < margin", "low > margin"),
                (r"first \|\| leads\)\)", "leads))"),
                (r"out_index <= count", "out_index <= count + 1"),
                (rf"margin <= {(1 << width) - 1}", f"margin <= {(1 << width) - 2}"),
                (r"folded = \(~low\)", "folded = low"),
                (r"in_valid && in_last", "in_last"),
                (r"rst == 1", "0"),
            ),
            clocks=outputs + 4,
        )
    ]
