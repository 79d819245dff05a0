"""Proved properties of argmax_tree, whatever the outputs are."""

from tb.common.properties import Property


def largest(twin):
    """Verilog of the largest output, its number and the second, found one after the other."""
    width, lines = twin.fmt.width, []
    lines.append(f"wire signed [{width - 1}:0] top_0 = in_data_0, second_0 = 0;")
    lines.append("wire [15:0] at_0 = 0;")
    for n in range(1, twin.outputs):
        new, old = f"in_data_{n}", n - 1
        lines += [
            f"wire leads_{n} = {new} > top_{old};",
            f"wire signed [{width - 1}:0] top_{n} = leads_{n} ? {new} : top_{old};",
            f"wire signed [{width - 1}:0] second_{n} = leads_{n} ? top_{old} : "
            f"{n} == 1 || {new} > second_{old} ? {new} : second_{old};",
            f"wire [15:0] at_{n} = leads_{n} ? {n} : at_{old};",
        ]
    return "\n".join(lines)


def properties(twin):
    width, late, last = twin.fmt.width, twin.latency, twin.outputs - 1
    span = 16 * late
    return [
        Property(
            name="winner",
            sentence=f"{late} clocks after a frame, out_index is the number of its largest output, "
            "the first of equal ones, and out_margin the difference between this output and the "
            "largest of the others.",
            states=(
                f"age < {late} || out_index == ats[{span - 1}:{span - 16}]",
                f"age < {late} || out_margin == leads[{span - 1}:{span - 16}]",
            ),
            watch=f"""
                {largest(twin)}
                wire [{width}:0] lead = top_{last} - second_{last};
                wire [15:0] lead_now = lead;
                reg [15:0] age = 0;
                reg [{span - 1}:0] ats, leads;
                always @(posedge clk) begin
                    age <= age == {late} ? {late} : age + 1;
                    ats <= {{ats, at_{last}}};
                    leads <= {{leads, lead_now}};
                end
            """,
            helps=(f"age <= {late}",),
            reached=(f"age == {late} && out_index == {last}",),
            refuted_by=(
                (r"(pair0_loses = \(\S+) <", r"\1 <="),
                (r"(pair0_winner_index <=) 1", r"\1 0"),
                (r"(meet0_closer = \(\S+) <", r"\1 >"),
                (r"pair1_winner_index \|", "pair1_winner_index &"),
                (r"(subtract0_lead = \(\S+) -", r"\1 +"),
            ),
            clocks=late + 3,
            induction=late + 1,
        )
    ]
