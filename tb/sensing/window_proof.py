"""The properties of a frame window, by itself or inside a network."""

from tb.common.properties import Property
from tb.common.watch import ago, frames, results


def window(twin, part, out, wrong=(), lost=()):
    """The properties of a frame window, by itself or inside a network.

    part: The prefix of its signals: "", or the name of its instance and a point.
    out: The prefix of the names of its output stream.
    wrong, lost: Further broken copies, for the property of frame_error and for that of the output
        stream.
    """
    sensors, spacing, elements = twin.sensors, twin.spacing, twin.elements
    late, past, interval = twin.latency, twin.past, twin.interval
    apart = spacing > 1
    least = f" or that ends less than {spacing} clocks after a good one" if apart else ""
    good, judge = f"{part}good", f"{part}judge0_"
    yields = f"{part}yields" if past else good
    found = [
        Property(
            name="frame_error",
            sentence="frame_error is high for exactly one clock for each frame that does not have "
            f"{sensors} samples{least}. It comes one clock after the sample that shows this. All "
            "other frames are good.",
            states=("frame_error == wrong_ago[0]", "was_good == good_ago[0]"),
            watch=frames(sensors, spacing, name="told_")
            + ago("wrong_ago", "told_wrong", 1)
            + ago("good_ago", "told_good", 1)
            + ago("was_good", good, 1),
            helps=(
                f"told_place == {judge}count",
                f"told_skipping == {judge}dropping",
                f"told_place < {sensors}",
                "!told_skipping || told_place == 0",
                f"told_closed == {f'{judge}remaining' if apart else 0}",
            ),
            reached=("frame_error", "told_skipping && in_valid", "was_good"),
            refuted_by=(
                (r"frame_error <= broken", "frame_error <= (broken && in_last)"),
                (r"judge0_dropping <= \(!in_last\)", "judge0_dropping <= 0"),
                (r"judge0_complete && in_last", "in_last"),
                *(((r" && \(!judge0_early\)", ""),) if apart else ()),
                *wrong,
            ),
            clocks=12,
        ),
        Property(
            name="elements",
            sentence=f"Each frame that yields, and nothing else, gives {elements} elements in "
            f"clocks {late} to {late + elements - 1} after its last sample, the last of them with "
            "last. A reset ends them.",
            states=(f"{out}valid == (left != 0)", f"{out}last == (left == 1)"),
            watch=f"""
                reg [15:0] gap = 0;
                always @(posedge clk) gap <= {yields} ? {interval - 1} : gap == 0 ? 0 : gap - 1;
            """
            + ago("yield_ago", yields, late)
            + results(elements, f"yield_ago[{late - 1}]"),
            assumes={
                f"Frames that yield are at least {interval} clocks apart, as all good ones are.": (
                    f"!({yields} && gap != 0)"
                )
            },
            helps=(
                f"{part}turn < {elements}",
                f"!{part}sending || gap == {interval - 1} - {part}turn",
                f"gap < {interval}",
            ),
            free=(yields,),
            reached=(f"{out}valid && {out}last",),
            refuted_by=(
                (r"turn == (\d+)", r"turn == \1 - 1"),
                (r"delay0_taps\[0\] <= 0;", ""),
                (r"sending <= 0;", ""),
                (r"delay1_taps\[0\] <= closing", "delay1_taps[0] <= sending"),
                *lost,
            ),
            clocks=late + elements + 4,
            induction=late + elements + 1,
        ),
    ]
    if past:
        found.append(
            Property(
                name="whole past",
                sentence=f"A good frame yields where {past} good ones have come since the last "
                "reset, and no other does.",
                states=("was_yielding == good_ago[0]",),
                watch=f"""
                    reg [15:0] known = 0;
                    always @(posedge clk) known <= rst ? 0 : {good} && known < {past} ? known + 1
                        : known;
                """
                + ago("was_yielding", yields, 1)
                + ago("good_ago", f"({good} && known == {past})", 1),
                helps=(f"known == {part}past_whole0_known", f"known <= {past}"),
                # The frame check may say anything here.
                free=(good,),
                reached=("was_yielding",),
                refuted_by=(
                    (r"known == (\d+)", r"known == \1 - 1"),
                    (r"good && past_whole0_whole", "good"),
                    (r"(?s)(past_whole0_count.*?)if \(rst == 1\)", r"\1if (0)"),
                ),
                clocks=past + 4,
            )
        )
    return found
