"""Proved properties of readout, whatever its network gives."""

from golden.numbers.precision import SIGNAL
from tb.common.properties import Property


def properties(twin):
    if not twin.holds:
        return []
    outputs, width = twin.outputs, SIGNAL.width
    stream = ("result_valid", "result", "result_last")
    words = "\n".join(
        f"""
            reg known_{n} = 0;
            reg [{width - 1}:0] newest_{n};
            always @(posedge clk) if (after_reset && result_valid && place == {n}) begin
                known_{n} <= 1;
                newest_{n} <= result;
            end
        """
        for n in range(outputs)
    )
    found = [
        Property(
            name="held outputs",
            sentence="Each output is held from the clock after it left until the next of its kind "
            "has left, whatever the network gives. A reset begins a new frame and changes no held "
            "output.",
            states=tuple(f"!known_{n} || held_{n} == newest_{n}" for n in range(outputs)),
            watch="""
                // Outputs of this frame so far.
                reg [15:0] place = 0;
                always @(posedge clk) begin
                    if (result_valid) place <= result_last ? 0 : place == 99 ? 99 : place + 1;
                    if (rst) place <= 0;
                end
            """
            + words,
            helps=(f"count == (place > {outputs} ? {outputs} : place)", "place <= 99"),
            free=stream,
            reached=tuple(f"known_{n}" for n in (0, outputs - 1)),
            refuted_by=(
                (r"result_valid && \(count == 1\)", "result_valid && (count <= 1)"),
                (r"if \(result_last\)", "if (0)"),
                (r"rst == 1", "0"),
                (r"assign held_0 = words_0", "assign held_0 = words_1"),
                (r"words_2 <= result", "words_2 <= -result"),
            ),
            clocks=outputs + 4,
        ),
    ]
    if twin.load_profile is not None:
        names = ("load", "position", "width", "shape")
        drawn = " && ".join(
            f"u_load_profile_0.in_{name} == held_{k}"
            for name, k in zip(names, twin.results, strict=True)
        )
        found.append(
            Property(
                name="drawn frames",
                sentence="The profile takes the held outputs one clock after the last output of a "
                "frame, unless a reset came between, and at no other time.",
                states=("u_load_profile_0.in_valid == was_last", drawn),
                watch="""
                    reg was_last = 0;
                    always @(posedge clk) was_last <= !rst && result_valid && result_last;
                """,
                free=stream,
                reached=("was_last",),
                refuted_by=(
                    (r"\(result_valid && result_last\)", "result_last"),
                    (r"draw0_complete <= 0", "draw0_complete <= result_last"),
                    (r"\.in_load\(words_\d\)", ".in_load(result)"),
                ),
                clocks=4,
            )
        )
    return found
