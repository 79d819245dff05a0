"""Proved properties of frame_check, whatever comes on its stream and whenever results are ready."""

from tb.common.properties import Property
from tb.common.watch import COMPUTED, MISPLACED, ago, opened, opening, operands

FINISHED = {"The last output leaves only while a frame is computed.": "run || !finish"}


def properties(twin):
    top = (1 << twin.addr_width) - 1
    # Where results are not counted there are none to be stored.
    kept = "taken || store" if twin.results else "taken"
    computed = COMPUTED if twin.results else FINISHED
    waits = twin.pipeline.run - 1
    watch = f"""
        reg [15:0] place = 0;
        reg skipping = 0, computing = 0;
        wire taken = in_valid && !computing && !skipping;
        wire is_good = taken && place == {twin.inputs - 1} && in_last;
        wire wrong = in_valid && !skipping
            && (computing || (in_last != (place == {twin.inputs - 1})));
        always @(posedge clk) begin
            if (taken) place <= is_good || wrong ? 0 : place + 1;
            if (in_valid) skipping <= !in_last && (skipping || wrong);
            computing <= is_good || (computing && !finish);
            if (rst) begin
                place <= 0;
                skipping <= 0;
                computing <= 0;
            end
        end
    """
    watch += opening(waits)
    helps = (
        *opened(waits),
        "dropping == skipping",
        f"place < {twin.inputs}",
        "!computing || place == 0",
        f"computing || addr == (place == 0 ? {top} : place - 1)",
    )
    common = {"assumes": computed, "helps": helps}
    return [
        Property(
            name="frame_error",
            sentence=f"frame_error is high for exactly one clock for each frame that does not have "
            f"{twin.inputs} samples or that begins while another is computed. It comes one clock "
            "after the sample that shows this.",
            states=("frame_error == wrong_ago[0]",),
            watch=watch + ago("wrong_ago", "wrong", 1),
            reached=("frame_error", "skipping && in_valid"),
            refuted_by=(
                (r"in_valid && busy && \(!dropping\)", "in_valid && busy"),
                (r"complete != in_last", "complete && !in_last"),
            ),
            **common,
        ),
        Property(
            name="good frames only",
            sentence="A good frame, and nothing else, starts the program, "
            f"{'one clock later, ' * waits}which runs until the last output leaves or a reset "
            "comes.",
            states=("start == opens_now", "run == going"),
            watch=watch,
            reached=("start", "run && in_valid"),
            refuted_by=(
                (r"accept && complete && in_last", "accept && complete"),
                (r"\(!busy\) && \(!dropping\)", "(!busy)"),
                (r"rst == 1\) begin\s+running", "0) begin running"),
            ),
            **common,
        ),
        Property(
            name="operands in order",
            sentence="Each sample that is taken is written to the operand memory one clock later. "
            "The first sample of a frame goes to address 0, and results go behind the samples. No "
            f"address is written twice for a frame, except {top}, where nothing is kept.",
            states=(
                "write == wrote_ago[0]",
                f"!write || write_addr == expected || (broke_ago[0] && write_addr == {top})",
            ),
            watch=watch
            + ago("wrote_ago", kept, 1)
            + ago("broke_ago", "taken && wrong", 1)
            + operands(twin.addr_width, kept, "finish || wrong && taken"),
            reached=("write && write_addr == 3",),
            refuted_by=MISPLACED if twin.results else MISPLACED[::2],
            assumes=computed,
            helps=(
                *helps,
                f"addr == ((operands + {top}) & {top})",
                "computing || operands == place",
                "!write || expected == addr || broke_ago[0]",
            ),
        ),
    ]
