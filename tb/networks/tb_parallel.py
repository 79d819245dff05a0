"""parallel, every multiplication at once, against its twin.

Recorded, corner, extreme and random frames come as close as it takes them, with gaps, closer, with
resets among them, and with one reset at each clock of a frame's way.
"""

import cocotb

from tb.common import at_once
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.properties import Property
from tb.common.watch import ago, frames

CASES = cases("parallel")
# A case whose activation takes a frame only every few clocks.
PROVED = ("pade-parallel",)
# The proof for every frame shows what a neuron computes.
SHOWN_BY_FRAMES = ("neuron",)


recorded, corners_and_random, reset_at_every_clock, resets_among_frames = at_once.suite(
    __name__, close=True
)


@cocotb.test()
async def too_close(dut):
    """Play frames closer than the design takes them, if it does not take one every clock."""
    bench = Bench(dut)
    pause = bench.rng.integers(0, bench.twin.interval + 1, 400)
    recording, _ = await at_once.check(bench, at_once.random_frames(bench, 400), 0.0, pause)
    errors = recording.rows("frame_error")
    assert bool(len(errors)) == (bench.twin.interval > 1), "frame_error is wrong throughout"
    bench.finish(at_least=20)


def properties(twin):
    spacing, late = twin.input_controller.spacing, twin.latency
    controller = "u_input_controller_0"
    refused = "frame_error is never high."
    if spacing:
        refused = "frame_error is high one clock after each frame that comes less than "
        refused += f"{spacing} clocks after a good one, which yields none, and in no other clock."
    return [
        Property(
            name="one for each",
            sentence=f"A frame, and nothing else, yields its outputs {late} clocks after it, "
            f"unless a reset came between. {refused}",
            states=(f"out_valid == good_ago[{late - 1}]", "frame_error == wrong_ago[0]"),
            # All samples come at once, so a frame is complete in the clock of in_valid.
            watch=frames(1, spacing).replace("in_last", "in_valid")
            + ago("good_ago", "good", late)
            + ago("wrong_ago", "wrong", 1),
            helps=(
                "place == 0 && !skipping",
                f"{controller}.count == 0 && !{controller}.dropping",
                f"closed == {f'{controller}.remaining' if spacing else '0'}",
            ),
            reached=("out_valid", "good_ago == 1", *(("frame_error",) if spacing else ())),
            refuted_by=(
                (r"delay1_taps\[0\] <= r_valid_0", "delay1_taps[0] <= (r_valid_0 || out_valid)"),
                (r"(q_valid|taps\[0\]) <= accepted", r"\1 <= whole"),
                (r"(delay1_taps\[0\]) <= 0;", ""),
                (r"frame_error <= broken", "frame_error <= accept"),
                (r" && \(!done\)", ""),
            ),
            clocks=late + 8,
            induction=late + 2,
        )
    ]
