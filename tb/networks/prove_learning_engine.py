"""Proved properties of learning_engine: learning changes no clock of a frame, and nothing by half.

The proofs do not cover what the data paths compute. A program has one jump, in the equations, and
frames have none, so the clocks of every frame are the same.
"""

from golden.learning.program import FRAME
from golden.numbers.precision import SIGNAL
from tb.common.properties import Property
from tb.common.watch import frames_computed

# This has one output, and so one equation.
ALSO = ("least-lesson",)
# Whatever the data paths compute, and whichever placements are kept.
FREE = ("read", "second", "table_word", "acc", "spoiled", "lesson_control0_none")
ONE_AT_A_TIME = "!(frame_start || frame_run) || !(studying || opening || goes)"


def properties(twin):
    return [outputs(twin), sound_readings(twin), whole_updates(), refused_steps()]


def outputs(twin):
    """Which outputs leave when."""
    inputs, first = twin.inputs, twin.program.starts[FRAME]
    left = " || ".join(f"since == {clock}" for clock in twin.output_clocks)
    none = (1 << twin.frame_check.addr_width) - 1
    watch = frames_computed(inputs, twin.busy, taken="accepted")
    watch += """
        reg [15:0] fetched_from;
        always @(posedge clk) fetched_from <= lesson_memory0_counter;
    """
    return Property(
        name="outputs of good frames",
        sentence="Each good frame, and nothing else, yields outputs in the clocks "
        f"{', '.join(map(str, twin.output_clocks))} after its last sample, the last one with "
        "out_last, whether it learns or not and whatever known outputs come. frame_error is high "
        "for one clock for each wrong frame, which yields no output.",
        states=(
            f"out_valid == ({left})",
            f"out_last == (since == {twin.output_clocks[-1]})",
            "frame_error == told",
        ),
        watch=watch,
        helps=(
            "frame_start == (since == 1) && frame_run == (since > 1)",
            "u_frame_check_0.waiting == (since == 1)",
            "u_frame_check_0.dropping == skipping",
            f"since <= {twin.busy} && place < {inputs} && (since == 0 || place == 0)",
            f"since != 0 || u_frame_check_0.addr == (place == 0 ? {none} : place - 1)",
            ONE_AT_A_TIME,
            f"since == 0 || lesson_memory0_counter == {first - 1} + since",
            f"since < 2 || fetched_from == {first - 2} + since",
            "since < 2 || word == lesson_memory0_memory[fetched_from]",
        ),
        free=FREE,
        reached=("since == 2", "studying && in_valid"),
        refuted_by=(
            (r"out_valid <= leaves", "out_valid <= (leaves || frame_start)"),
            (r"early \|\| broken", "broken"),
        ),
        clocks=inputs + 9,
        induction=6,
    )


def sound_readings(twin):
    """Behind which frames known outputs and theta are taken."""
    none, final = (1 << twin.frame_check.addr_width) - 1, twin.inputs - 1
    low, high = f"-{SIGNAL.width}'sd{-SIGNAL.low}", f"{SIGNAL.width}'sd{SIGNAL.high}"
    computed = "(frame_start || frame_run)"
    arrives = f"(in_valid && !{computed})"
    watch = f"""
        // The number of the next sample of a frame; whether one of them was at an end.
        reg [15:0] place = 0;
        reg met_end = 0, sound = 0;
        wire met_end_now = sample_write ? at_low || at_high || (clipped && continues) : clipped;
        always @(posedge clk) begin
            if (u_frame_check_0.accept) begin
                place <= in_last || place == {final} ? 0 : place + 1;
                met_end <= in_data == {low} || in_data == {high} || (met_end && place != 0);
            end
            sound <= !{arrives} && (frame_finish ? !met_end : sound);
            if (rst) begin
                place <= 0;
                sound <= 0;
            end
        end
    """
    return Property(
        name="sound readings",
        sentence="Known outputs and theta are taken from the last output of a frame up to the next "
        "sample, unless a sample of the frame was at an end of its range.",
        states=("fresh == sound", f"halt == (({arrives} || !sound) && !keep_busy)"),
        watch=watch,
        helps=(
            "u_frame_check_0.waiting == frame_start && !(frame_start && frame_run)",
            f"place <= {final} && (place == 0 || !{computed})",
            f"{computed} || u_frame_check_0.addr == (place == 0 ? {none} : place - 1)",
            f"!frame_start || !sample_write || u_frame_check_0.addr == {final}",
            f"(place == 0 && !{computed}) || met_end_now == met_end",
            "!frame_run || !sample_write",
        ),
        # A frame may end in any clock.
        free=(*FREE, "finish"),
        reached=("fresh", "frame_run && clipped"),
        refuted_by=(
            (r"fresh <= \(!clipped\)", "fresh <= 1'b1"),
            (r"clipped && continues", "clipped"),
            (r"at_low \|\| at_high", "at_low"),
        ),
        clocks=2 * twin.inputs + 9,
        induction=3,
    )


def whole_updates():
    """When theta is exchanged."""
    return Property(
        name="whole updates",
        sentence="While a frame is computed, no equation is, and the theta that is read stays. "
        "It is exchanged in the clock after the last result of an equation in which no word of "
        "the new theta was saturated, and behind a stream of theta, and in no other clock. No "
        "equation is computed between two words of such a stream.",
        states=(
            "!(frame_start || frame_run) || !studying",
            "!(ran_before && frame_run) || bank == bank_before",
            "reset_before || (bank != bank_before) == ((passed_before && !bad_before) "
            "|| put_before)",
            "!partly || !(studying || opening || goes)",
        ),
        watch=BEFORE,
        helps=(ONE_AT_A_TIME,),
        # A part may end in any clock.
        free=(*FREE, "finish"),
        reached=(
            "frame_run && ran_before",
            "bank != bank_before && !reset_before",
            "put_before && !reset_before",
        ),
        refuted_by=(
            (r"lesson_control0_passed && \(!bad\)", "lesson_control0_passed"),
            (r"\(arrives \|\| taken\)", "taken"),
            (r"learn && ready &&", "learn &&"),
            (r"lesson_control0_put \|\| ", "finish || "),
            (r"telling \|\| partly", "telling"),
        ),
        clocks=24,
    )


def refused_steps():
    """What happens to a step that would leave the range."""
    return Property(
        name="steps that are refused",
        sentence="learn_error is high for one clock, in the clock after the last result of an "
        "equation in which a word of the new theta was saturated. The theta that is read stays.",
        states=(
            "learn_error == (passed_before && bad_before)",
            "!learn_error || put_before || bank == bank_before",
        ),
        watch=BEFORE,
        free=(*FREE, "finish"),
        refuted_by=(
            (r"learn_error <= \(lesson_control0_passed && bad\)", "learn_error <= bad"),
            (r"lesson_control0_passed && \(!bad\)", "lesson_control0_passed"),
        ),
    )


BEFORE = """
    reg bank_before, ran_before = 0, passed_before = 0, bad_before, reset_before = 1;
    reg put_before = 0;
    always @(posedge clk) begin
        bank_before <= bank;
        ran_before <= frame_run;
        passed_before <= lesson_control0_passed && !rst;
        bad_before <= bad;
        put_before <= keep_run && finish && putting && !rst;
        reset_before <= rst;
    end
"""
