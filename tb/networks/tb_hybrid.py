"""hybrid, the whole folded network, against its twin: the tests of tb/common/network.py."""

from tb.common import watch
from tb.common.case_library import cases
from tb.common.network import TESTS
from tb.common.properties import Property

CASES = cases("folded", "precise", "segments")
# A case in which the least distance of frames is more than their length.
PROVED = ("drawn",)

recorded, corners_and_random, wrong_lengths, resets_in_mid_frame, reset_at_every_clock = TESTS


def properties(twin):
    controller = "u_input_controller_0"
    too_soon = (r"accept && complete && in_last", "accept && in_last")
    if twin.input_controller.spacing:
        too_soon = (r" && \(!early\)", "")
    return [
        *watch.network(
            twin,
            controller,
            wrong=(
                (r"&& \(!done\)", "&& (!in_last)"),
                (r"frame_error <= broken", "frame_error <= (broken && in_last)"),
                too_soon,
            ),
            good=(
                (r"accept && complete && in_last", "accept && complete"),
                (r"\.in_valid\(r_valid_0\)", ".in_valid(q_valid)"),
                (r"delay3_taps\[1\] <= 0;", ""),
                (r"in_valid \|\| \(count != 0\)", "in_valid"),
            ),
        ),
        Property(
            name="activations of one frame",
            sentence="While the outputs of a frame are weighed, the activations stay those of that "
            "frame: none comes from a later frame.",
            states=("!r_valid_0 || row == 0",),
            reached=("r_valid_0", "row != 0"),
            refuted_by=(too_soon,),
            clocks=twin.latency + twin.outputs,
            induction=twin.latency + twin.outputs,
        ),
    ]
