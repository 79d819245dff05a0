"""Proved properties of load_profile, whatever its parts give, and of its divider."""

from tb.common.properties import Property
from tb.common.watch import read_only

# For each result, the register that holds it while it is drawn.
DRAWN = {"load": "load", "position": "centre", "width": "width", "shape": "shape"}


def properties(twin):
    bits = twin.fmt.width
    newest = "\n".join(f"reg [{bits - 1}:0] newest_{n}, shown_{n};" for n in DRAWN)
    taken = "\n".join(f"if (in_valid) newest_{n} <= in_{n};" for n in DRAWN)
    shown = "\n".join(f"if (begins) shown_{n} <= newest_{n};" for n in DRAWN)
    return [
        Property(
            name="newest frame",
            sentence="A ramp begins with the newest results that came since the ramp before it "
            "began, as soon as that one has given its last point. It keeps these results to its "
            "end, whatever comes meanwhile. A reset ends it.",
            states=(
                "restart == begins",
                *(f"!drawing || {place} == shown_{n}" for n, place in DRAWN.items()),
            ),
            watch=f"""
                reg came = 0, drawing = 0, known = 0;
                wire begins = came && !drawing;
                {newest}
                always @(posedge clk) begin
                    came <= in_valid || came && !begins;
                    drawing <= begins || drawing && !(out_valid && out_last);
                    known <= known || in_valid;
                    {taken}
                    {shown}
                    if (rst) begin
                        came <= 0;
                        drawing <= 0;
                    end
                end
            """,
            helps=(
                "waiting == came && busy == drawing",
                "!came || known",
                *(f"!known || results0_{n}_held == newest_{n}" for n in DRAWN),
            ),
            free=("point_valid", "point_last"),
            reached=("drawing && came", "begins && in_valid"),
            refuted_by=(
                (r"waiting && \(!busy\)", "waiting"),
                (r"\(point_valid && point_last\)", "point_valid"),
                (r"waiting <= 1'b0", "waiting <= 1'b1"),
                (r"centre <= results0_position_held", "centre <= in_position"),
                (r"busy <= 0;", ""),
            ),
            clocks=6,
        ),
    ]


def divider(twin):
    late = twin.latency
    return [
        Property(
            name="no overflow",
            sentence="While digits are found, the remainder is below the divisor, and their "
            "difference keeps every bit, so that no step loses a bit. The numerator has room for "
            "every distance.",
            states=(
                "remaining == 0 || load || remainder < divisor",
                "whole_trial == $signed(trial)",
                "whole_product == product",
            ),
            watch=f"""
                // Clocks since the one after the last in_valid; 255 where a reset came since.
                reg begun = 0;
                reg [7:0] age = 255;
                always @(posedge clk) begin
                    begun <= !rst && in_valid;
                    age <= rst ? 255 : begun ? 0 : age == 255 ? 255 : age + 1;
                end
                wire signed [63:0] whole_trial = $signed({{32'b0, shifted}})
                    - $signed({{32'b0, divisor}});
                wire [63:0] whole_product = in_distance * 64'd{twin.gain};
            """,
            helps=(
                "load == begun",
                f"remaining == (age < {late - 2} ? {late - 2} - age : 0)",
                "remaining == 0 || load || divisor != 0",
            ),
            reached=("remaining == 1",),
            refuted_by=(
                (r"if \(fits\)", "if (!fits)"),
                (r"divisor <= 1;", "divisor <= 0;"),
                (r"wire \[16:0\] product", "wire [15:0] product"),
            ),
            clocks=late + 2,
        ),
    ]


def exp_memory(twin):
    return [read_only(twin, ((r"0: word <= ", "0: word <= 1 + "),))]


PARTS = {"divider": divider, "exp_memory": exp_memory}
