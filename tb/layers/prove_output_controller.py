"""Proved properties of output_controller, whatever drives it."""

from tb.common.properties import Property


def properties(twin):
    outputs = twin.outputs
    watch = f"""
        // Clocks since the in_valid that was the cause, as many as there are outputs, or none.
        reg [15:0] due = 0;
        wire [15:0] left = in_valid && due == 0 ? {outputs} : due;
        always @(posedge clk) due <= rst || left == 0 ? 0 : left - 1;
    """
    return [
        Property(
            name="cause",
            sentence="Rows are valid in the clocks that follow an in_valid, one for each output, "
            "and in no others; a reset ends them.",
            states=("out_valid == (left != 0)",),
            watch=watch,
            helps=(f"due <= {outputs - 1}", f"count == (due == 0 ? 0 : {outputs} - due)"),
            reached=("out_valid", "!out_valid"),
            refuted_by=(
                (r"out_valid = \(in_valid \|\| \(count != 0\)\)", "out_valid = (count != 0)"),
                (r"rst == 1", "0"),
            ),
        ),
        Property(
            name="rows in order",
            sentence="One row after the other is asked for. The first one comes with in_valid, and "
            "out_last marks the last one and no other.",
            states=(
                f"!out_valid || addr == {outputs} - left",
                "out_last == (left == 1)",
            ),
            watch=watch,
            helps=(f"due <= {outputs - 1}", f"count == (due == 0 ? 0 : {outputs} - due)"),
            reached=("out_last",),
            refuted_by=((r"\((\d+) - 1\)", r"(\1)"), (r"count \+ 1", "count + 2")),
        ),
    ]
