"""Proved properties of frame_guard, whatever comes on its stream and whenever images are loaded."""

from tb.common.properties import Property
from tb.common.watch import COMPUTED, MISPLACED, ago, opened, opening, operands


def properties(twin):
    top = (1 << twin.addr_width) - 1
    waits = twin.pipeline.run - 1
    watch = f"""
        // The frame on the stream: samples of it so far, and whether it can still be good.
        reg [15:0] place = 0;
        reg inside = 0, spoiled = 0, computing = 0;
        wire [15:0] length = {{9'b0, before_last}} + 2 & {top};
        wire ends_here = place + 1 == (length == 0 ? {top + 1} : length);
        wire fits = in_valid && !spoiled && !computing && !halt;
        wire is_good = fits && ends_here && in_last;
        wire is_wrong = !spoiled
            && (in_valid ? computing || halt || ends_here != in_last : inside && halt);
        always @(posedge clk) begin
            if (in_valid) inside <= !in_last;
            if (in_valid) place <= in_last || is_wrong || spoiled ? 0 : place + 1;
            else if (is_wrong) place <= 0;
            if (in_valid) spoiled <= !in_last && (spoiled || is_wrong);
            else if (is_wrong) spoiled <= 1;
            computing <= is_good || (computing && !finish);
            if (rst) begin
                place <= 0;
                inside <= 0;
                spoiled <= 0;
                computing <= 0;
            end
        end
        reg [{twin.addr_width - 1}:0] was_before_last;
        reg was_halted = 1;
        always @(posedge clk) begin
            was_before_last <= before_last;
            was_halted <= halt || rst;
        end
    """
    watch += opening(waits)
    assumes = {
        **COMPUTED,
        "halt never comes while a frame is computed.": "!(halt && busy)",
        "before_last changes only while halt is high.": "was_halted || "
        "before_last == was_before_last",
    }
    helps = (
        *opened(waits),
        "dropping == spoiled",
        "started == inside",
        "!spoiled || inside",
        "!computing || (place == 0 && !inside) || spoiled",
        "!(spoiled || computing || !inside) || place == 0",
        "!inside || spoiled || place != 0",
        f"place <= {top}",
        f"place == 0 || was_halted || place < (length == 0 ? {top + 1} : length) ",
        f"computing || addr == ((place + {top}) & {top})",
    )
    common = {"assumes": assumes, "helps": helps}
    return [
        Property(
            name="frame_error",
            sentence="frame_error is high for exactly one clock for each frame that does not have "
            "the length that the image names, that begins while another is computed, or that has a "
            "clock with halt from its first sample to its last. It comes one clock after what "
            "breaks the frame.",
            states=("frame_error == wrong_ago[0]",),
            watch=watch + ago("wrong_ago", "is_wrong", 1),
            reached=("frame_error", "spoiled && in_valid", "inside && halt && !spoiled"),
            refuted_by=(
                (r"in_valid && closed", "in_valid && closed && in_last"),
                (r"halt && \(in_valid \|\| started\)", "halt && in_valid"),
                (r"dropping <= 1'b1", "dropping <= 1'b0"),
                (r"complete != in_last", "complete && !in_last"),
            ),
            **common,
        ),
        Property(
            name="good frames only",
            sentence=f"The program starts {'one clock after' if waits else 'with'} the last sample "
            "of a good frame, in a clock without halt, and in no other clock. It runs until the "
            "last output leaves or a reset comes.",
            states=("start == opens_now", "run == going", "busy == computing", "!(start && halt)"),
            watch=watch,
            reached=("start", "run && in_valid"),
            refuted_by=(
                (r"accept && complete && in_last", "accept && complete"),
                (r"closed \|\| halt \|\| dropping", "closed || dropping"),
                (r"closed \|\| halt \|\| dropping", "closed || halt"),
                (r"broken \|\| halt", "broken"),
            ),
            **common,
        ),
        Property(
            name="operands in order",
            sentence="Each sample that is taken, and each result, is written to the operand memory "
            "one clock later. The first of a frame goes to address 0, and each other goes behind "
            "the one before.",
            states=(
                "write == wrote_ago[0]",
                f"!write || write_addr == expected || (broke_ago[0] && write_addr == {top})",
            ),
            watch=watch
            + ago("wrote_ago", "fits || store", 1)
            + ago("broke_ago", "is_wrong", 1)
            + operands(
                twin.addr_width, "fits || store", "finish || is_wrong && !computing || halt"
            ),
            reached=("write && write_addr == 3",),
            refuted_by=MISPLACED,
            assumes=assumes,
            helps=(
                *helps,
                f"addr == ((operands + {top}) & {top})",
                "!write || expected == addr || broke_ago[0]",
            ),
        ),
    ]
