"""lanes, a whole scene on several multipliers, against its twin.

Sweeps: all recorded frames of the scene; corner frames (rails, alternating rails, zeros, one sensor
at a rail); frames that drive each hidden sum to both of its ends; 100 random frames; frames that
are too short or too long among good frames. If the lanes can be reloaded: the images that the bench
of engine loads, good and wrong ones.
Drives: frames as close as the design takes them, with random gaps, closer than it takes them, with
resets in mid-frame, and with one reset at each clock of a frame, or at many clocks of a long frame.
If the lanes can be reloaded: images before, between and in the middle of frames, bytes with gaps,
and resets while an image is loaded.
In a loop frames overlap; with gaps most of them wait for the loop to begin anew.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock, and that no output
comes in any other clock; ``load_ready`` and ``image_error`` too. The twin executes the words of the
program and of the lanes, or those that are loaded. The bench also measures the clocks of a frame.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

from tb.common.case_library import LANES, OVERLAPPED, RELOADED_LANES
from tb.common.network import (
    corners_and_random,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    wrong_lengths,
)
from tb.networks.tb_engine import (
    SCENES,
    frames_while_loading,
    images_one_after_the_other,
    networks_of_other_depth,
    networks_of_other_functions,
    other_numbers_of_samples,
    resets_while_loading,
    wrong_images_among_good_ones,
)

CASES = LANES | OVERLAPPED | RELOADED_LANES
# The first has a table, and this one has ReLU and none. What quantised networks and functions add
# is in lane_round and lane_memory alone, which have records of these.
ALSO = ("relu-lanes",)

__all__ = [
    "SCENES",
    "corners_and_random",
    "frames_while_loading",
    "images_one_after_the_other",
    "networks_of_other_depth",
    "networks_of_other_functions",
    "other_numbers_of_samples",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "resets_while_loading",
    "wrong_images_among_good_ones",
    "wrong_lengths",
]
