"""Proved properties of input_controller, whatever drives it."""

from tb.common.properties import Property
from tb.common.watch import ago, frames

# A case in which the least distance of frames is more than their length.
ALSO = ("drawn",)


def properties(twin):
    watch = frames(twin.inputs, twin.spacing)
    helps = [
        "place == count",
        "skipping == dropping",
        f"place < {twin.inputs}",
        "!skipping || place == 0",
    ]
    helps += ["closed == remaining"] if twin.spacing else ["closed == 0"]
    apart = f" or that ends less than {twin.spacing} clocks after a good one"
    least = apart if twin.spacing else ""
    shared = {"watch": watch, "helps": tuple(helps)}
    return [
        Property(
            name="frame_error",
            sentence=f"frame_error is high for exactly one clock for each frame that does not have "
            f"{twin.inputs} samples{least}. It comes one clock after the sample that shows this.",
            states=("frame_error == wrong_ago[0]",),
            reached=("frame_error", "skipping && in_valid"),
            refuted_by=(
                (r"&& \(!done\)", "&& (!in_last)"),
                (r"in_valid && \(!dropping\)", "in_valid"),
                (r"dropping <= \(!in_last\)", "dropping <= 0"),
            ),
            **(shared | {"watch": watch + ago("wrong_ago", "wrong", 1)}),
        ),
        Property(
            name="good frames only",
            sentence=f"capture is high 3 clocks, and out_valid {twin.latency} clocks, after the "
            "last sample of a good frame, unless a reset came between. They are high in no other "
            "clock.",
            states=("capture == good_ago[2]", f"out_valid == good_ago[{twin.latency - 1}]"),
            reached=("out_valid",),
            refuted_by=(
                (r"accept && complete && in_last", "accept && complete"),
                (r"delay3_taps\[0\] <= done", "delay3_taps[0] <= complete"),
                (r"rst == 1", "0"),
            ),
            induction=twin.latency + 2,
            clocks=12,
            **(shared | {"watch": watch + ago("good_ago", "good", twin.latency)}),
        ),
        Property(
            name="every sample once",
            sentence="For each sample of a frame that is not yet known to be wrong, addr is its "
            "position, and it is added two clocks later. preset comes only with the first sample "
            "of a frame.",
            states=(
                "!taken || addr == place",
                "accumulate == taken_ago[1]",
                "preset == first_ago[1]",
            ),
            reached=("preset", "accumulate && !preset"),
            refuted_by=(
                (r"accept && \(count == 0\)", "accept"),
                (r"count <= \(count \+ 1\)", "count <= count"),
            ),
            **(
                shared
                | {
                    "watch": watch
                    + ago("taken_ago", "taken", 2)
                    + ago("first_ago", "taken && place == 0", 2)
                }
            ),
        ),
    ]
