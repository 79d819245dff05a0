"""Proved properties of output_collector, whatever drives it."""

from tb.common.properties import Property


def properties(twin):
    outputs = twin.outputs
    words = "\n".join(f"if (in_valid) word_{n} <= in_data_{n};" for n in range(outputs))
    chosen = " : ".join([*(f"left == {outputs - n} ? word_{n}" for n in range(outputs)), "0"])
    watch = (
        f"""
        // Words still to come, and those that came with the last in_valid.
        reg [15:0] left = 0;
        always @(posedge clk) left <= rst ? 0 : in_valid ? {outputs} : left == 0 ? 0 : left - 1;
    """
        + "\n".join(f"reg signed [{twin.fmt.width - 1}:0] word_{n};" for n in range(outputs))
        + f"""
        always @(posedge clk) begin
            {words}
        end
        wire signed [{twin.fmt.width - 1}:0] chosen = {chosen};
    """
    )
    helps = [f"left <= {outputs}", "remaining == left", "left == 0 || first == chosen"]
    for n in range(1, outputs):
        # Word n is n places behind the first, and one place nearer with each word that has left.
        for place in range(1, n + 1):
            helps.append(f"left != {outputs - n + place} || words_{place} == word_{n}")
    return [
        Property(
            name="all words once",
            sentence=f"After an in_valid, and after nothing else, the {outputs} words that came "
            "with it leave in the next clocks, each once and in order. out_last comes with the "
            "last of them. A reset ends them.",
            states=(
                "out_valid == (left != 0)",
                "out_last == (left == 1)",
                "!out_valid || out_data == chosen",
            ),
            watch=watch,
            helps=tuple(helps),
            reached=("out_last",),
            refuted_by=(
                (r"remaining <= 3", "remaining <= 2"),
                (r"remaining == 1", "remaining == 2"),
                (r"first <= words_1", "first <= words_2"),
                (r"rst == 1", "0"),
            ),
        )
    ]
