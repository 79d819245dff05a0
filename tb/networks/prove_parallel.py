"""Proved properties of parallel, whatever comes on its ports."""

from tb.common.properties import Property
from tb.common.watch import ago, frames

# A case whose activation takes a frame only every few clocks.
ALSO = ("pade-parallel",)


def properties(twin):
    spacing, late = twin.input_controller.spacing, twin.latency
    controller = "u_input_controller_0"
    helps = [
        "place == 0 && !skipping",
        f"{controller}.count == 0 && !{controller}.dropping",
        f"closed == {f'{controller}.remaining' if spacing else '0'}",
    ]
    # All samples come at once, so a frame is complete in the clock of in_valid.
    watch = frames(1, spacing).replace("in_last", "in_valid")
    no_result = "A frame that comes too early yields none." if spacing else "No frame is refused."
    return [
        Property(
            name="one for each",
            sentence=f"A frame, and nothing else, yields its outputs {late} clocks after it, "
            f"unless a reset came between. {no_result}",
            states=(f"out_valid == good_ago[{late - 1}]",),
            watch=watch + ago("good_ago", "good", late),
            helps=tuple(helps),
            reached=("out_valid", "good_ago == 1"),
            refuted_by=(
                (r"delay1_taps\[0\] <= r_valid_0", "delay1_taps[0] <= (r_valid_0 || out_valid)"),
                (r"q_valid <= accepted", "q_valid <= whole"),
                (r"(delay1_taps\[0\]) <= 0;", ""),
            ),
            clocks=late + 8,
            induction=late + 2,
        ),
        Property(
            name="frame_error",
            sentence="frame_error is high one clock after each frame that comes less than "
            f"{spacing} clocks after a good one, and in no other clock."
            if spacing
            else "frame_error is never high.",
            states=("frame_error == wrong_ago[0]",),
            watch=watch + ago("wrong_ago", "wrong", 1),
            helps=tuple(helps),
            reached=("frame_error",) if spacing else (),
            refuted_by=(
                (r"frame_error <= broken", "frame_error <= accept"),
                (r" && \(!done\)", ""),
            ),
        ),
    ]
