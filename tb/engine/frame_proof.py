"""The properties of frame_check and frame_guard, whatever comes on the stream.

frame_guard is a frame_check whose frames have the length that an image names, and break where
``halt`` comes.
"""

from tb.common.properties import Property
from tb.common.watch import ago

FINISHED = {"The last output leaves only while a frame is computed.": "run || !finish"}
COMPUTED = {
    "Results come, and the last output leaves, only while a frame is computed.": "run || "
    "!(store || finish)",
    "The last output is no result that goes back to the memory.": "!(store && finish)",
}
# Broken copies, in which operands get wrong addresses.
MISPLACED = (
    (r"addr <= \(addr \+ 1\)", "addr <= (addr + 2)"),
    (r"write <= \(accept \|\| store\)", "write <= accept"),
    (r"finish \|\| broken", "finish"),
)


def frame_check(twin):
    watch = f"""
        wire halt = 0;
        wire ends_here = place == {twin.inputs - 1};
    """
    # Where results are not counted there are none to be stored.
    return judged(
        twin,
        watch,
        COMPUTED if twin.results else FINISHED,
        (f"place < {twin.inputs}",),
        stored=" || store" * twin.results,
        kinds=f"does not have {twin.inputs} samples or that begins while another is computed",
        # A frame of one sample is never too short.
        wrong=(
            (r"in_valid && busy && \(!dropping\)", "in_valid && busy"),
            *([(r"complete != in_last", "complete && !in_last")] if twin.inputs > 1 else []),
        ),
        good=(
            (r"accept && complete && in_last", "accept && complete"),
            (r"\(!busy\) && \(!dropping\)", "(!busy)"),
            (r"rst == 1\) begin\s+running", "0) begin running"),
        ),
        misplaced=MISPLACED if twin.results else MISPLACED[::2],
    )


def frame_guard(twin):
    top = (1 << twin.addr_width) - 1
    watch = f"""
        wire [15:0] length = {{9'b0, before_last}} + 2 & {top};
        wire [15:0] whole = length == 0 ? {top + 1} : length;
        wire ends_here = place + 1 == whole;
        reg [{twin.addr_width - 1}:0] was_before_last;
        reg was_halted = 1;
        always @(posedge clk) begin
            was_before_last <= before_last;
            was_halted <= halt || rst;
        end
    """
    assumes = {
        **COMPUTED,
        "halt never comes while a frame is computed.": "!(halt && busy)",
        "before_last changes only while halt is high.": "was_halted || "
        "before_last == was_before_last",
    }
    return judged(
        twin,
        watch,
        assumes,
        ("started == inside", f"place <= {top}", "place == 0 || was_halted || place < whole"),
        stored=" || store",
        kinds="does not have the length that the image names, that begins while another is "
        "computed, or that has a clock with halt from its first sample to its last",
        wrong=(
            (r"in_valid && closed", "in_valid && closed && in_last"),
            (r"halt && \(in_valid \|\| started\)", "halt && in_valid"),
            (r"dropping <= 1'b1", "dropping <= 1'b0"),
            (r"complete != in_last", "complete && !in_last"),
        ),
        good=(
            (r"accept && complete && in_last", "accept && complete"),
            (r"closed \|\| halt \|\| dropping", "closed || dropping"),
            (r"closed \|\| halt \|\| dropping", "closed || halt"),
            (r"broken \|\| halt", "broken"),
        ),
        misplaced=MISPLACED,
        busy=("busy == computing", "!(start && halt)"),
    )


def judged(twin, watch, assumes, helps, *, stored, kinds, wrong, good, misplaced, busy=()):
    """The properties of both, which say all that they do.

    watch: Says with ``ends_here`` which sample of a frame is the last one.
    stored: Whether a result is stored, behind the samples.
    kinds: Which frames are wrong.
    wrong, good, misplaced: Broken copies that refute the properties, in their order.
    busy: What else holds while a frame is computed.
    """
    top, waits = (1 << twin.addr_width) - 1, twin.pipeline.run - 1
    watch = f"""
        // The frame on the stream: samples of it so far, and whether it can still be good.
        reg [15:0] place = 0;
        reg inside = 0, spoiled = 0, computing = 0;
        {watch}
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
        {ago("good_ago", "is_good", 1)}
        // The program starts, and it runs until finish.
        wire opens_now = {"good_ago" if waits else "is_good"};
        reg going = 0;
        always @(posedge clk) going <= !rst && (opens_now || (going && !finish));
    """
    begun = ("running == computing", "going == computing")
    if waits:
        begun = (
            "running == going",
            "start == good_ago && waiting == good_ago",
            "computing == (going || good_ago) && !(going && good_ago)",
        )
    helps = (
        *begun,
        *helps,
        "dropping == spoiled",
        "!spoiled || inside",
        "!computing || (place == 0 && !inside) || spoiled",
        "!(spoiled || computing || !inside) || place == 0",
        "!inside || spoiled || place != 0",
        f"computing || addr == ((place + {top}) & {top})",
    )
    common = {"assumes": assumes, "helps": helps}
    return [
        Property(
            name="frame_error",
            sentence=f"frame_error is high for exactly one clock for each frame that {kinds}. It "
            "comes one clock after what breaks the frame.",
            states=("frame_error == wrong_ago[0]",),
            watch=watch + ago("wrong_ago", "is_wrong", 1),
            reached=(
                *("frame_error", "spoiled && in_valid"),
                *(("inside && halt && !spoiled",) if busy else ()),
            ),
            refuted_by=wrong,
            **common,
        ),
        Property(
            name="good frames only",
            sentence=f"The program starts {'one clock after' if waits else 'with'} the last sample "
            "of a good frame, and in no other clock. It runs until the last output leaves or a "
            "reset comes.",
            states=("start == opens_now", "run == going", *busy),
            watch=watch,
            reached=("start", "run && in_valid"),
            refuted_by=good,
            **common,
        ),
        Property(
            name="operands in order",
            sentence="Each sample that is taken, and each result, is written to the operand memory "
            "one clock later. The first of a frame goes to address 0, and each other goes behind "
            f"the one before. A sample that breaks its frame may go to {top}.",
            states=(
                "write == wrote_ago[0]",
                f"!write || write_addr == expected || (broke_ago[0] && write_addr == {top})",
            ),
            watch=watch
            + ago("wrote_ago", f"(fits{stored})", 1)
            + ago("broke_ago", "is_wrong", 1)
            + f"""
                // Operands of this frame before this clock; where one of a clock ago belongs.
                reg [{twin.addr_width - 1}:0] operands = 0;
                reg [{twin.addr_width - 1}:0] expected;
                always @(posedge clk) begin
                    expected <= operands;
                    if (fits{stored}) operands <= operands + 1;
                    if (rst || finish || is_wrong && !computing || halt) operands <= 0;
                end
            """,
            reached=("write && write_addr == 3",) if stored else ("write",),
            refuted_by=misplaced,
            assumes=assumes,
            helps=(
                *helps,
                f"addr == ((operands + {top}) & {top})",
                "!write || expected == addr || broke_ago[0]",
            ),
            whole=True,
        ),
    ]
