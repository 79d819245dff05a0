"""Proved properties of load_profile, whatever its parts give, and of its table."""

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


def exp_memory(twin):
    return [read_only(twin, ((r"0: word <= ", "0: word <= 1 + "),))]


PARTS = {"exp_memory": exp_memory}
