"""adder_graph, every sum a graph of shifted adds, against its twin.

Recorded, corner, extreme and random frames come in every clock, with gaps, with resets among them,
and with one reset at each clock of a frame's way. Outputs and winner are compared in their clocks.
"""

from tb.activation.tb_bipartite import LATE
from tb.common import at_once
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.watch import ago, pipeline

CASES = cases("adder-graphs")
# A network without tables, with ReLUs and halves that go to the even code, that finds its largest
# output.
PROVED = ("exact-graph",)
# The proof for every frame shows that each sum is that of the twin's graph.
SHOWN_BY_FRAMES = ("constant_matrix",)


recorded, corners_and_random, reset_at_every_clock, resets_among_frames = at_once.suite(__name__)


def winner(twin):
    """The property that index and margin come for each frame."""
    late = twin.argmax.latency
    return Property(
        name="winner",
        sentence=f"winner_valid is exactly what out_valid was {late} clocks before, unless a reset "
        "came between.",
        states=(f"winner_valid == out_ago[{late - 1}]",),
        watch=ago("out_ago", "out_valid", late),
        reached=("winner_valid",),
        refuted_by=((r"winner_valid <= delay[^;]+", "winner_valid <= y_valid"),),
        clocks=twin.latency + late + 2,
        induction=late + 1,
    )


def properties(twin):
    # The last delay of the flag begins behind the tables of tanh, where there are any.
    broken = (
        (r"(delay1_taps\[0\]) <= r_valid_0", r"\1 <= (r_valid_0 || out_valid)"),
        (r"q_valid <= in_valid", "q_valid <= (in_valid && !q_valid)"),
        (r"(delay1_taps\[0\]) <= 0;", ""),
    )
    if not any(getattr(twin, "activations", ())):
        broken = (
            (r"(delay0_taps\[0\]) <= in_valid", r"\1 <= (in_valid && !\1)"),
            (r"(delay0_taps\[0\]) <= 0;", ""),
        )
    return [
        pipeline(twin, broken),
        *([winner(twin)] if twin.argmax else []),
        Property(
            name="frame_error",
            sentence="frame_error is never high.",
            states=("!frame_error",),
            reached=("out_valid",),
            refuted_by=((r"frame_error <= 1'b0", "frame_error <= in_valid"),),
            clocks=twin.latency + 2,
        ),
    ]


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


def argmax_tree(twin):
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
                (r"(subtract0_lead = \(\S+) -", r"\1 +"),
            ),
            clocks=late + 3,
            induction=late + 1,
            whole=True,
        )
    ]


def bipartite_pair(twin):
    return [pipeline(twin, LATE)]


OF_PARTS = {"argmax_tree": argmax_tree, "bipartite_pair": bipartite_pair}
