"""The properties of frame_check, frame_guard and image_loader, whatever comes on the streams.

frame_guard is a frame_check whose frames have the length that an image names, and break where
``halt`` comes.
"""

from golden.engine.formats import WORD_WIDTH
from golden.engine.image import LAST_ADDR, WORD_BYTES
from tb.common.properties import Property
from tb.common.watch import ago, check_byte

FINISHED = {"The last output leaves only while a frame is computed.": "run || !finish"}
COMPUTED = {
    "Results come, and the last output leaves, only while a frame is computed.": "run || "
    "!(store || finish)",
    "The last output is no result that goes back to the memory.": "!(store && finish)",
}


# A broken copy in which no result is written.
STORED = (r"write <= \(accept \|\| store\)", "write <= accept")


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
        faults=(
            (r"in_valid && busy && \(!dropping\)", "in_valid && busy"),
            (r"accept && complete && in_last", "accept && complete"),
            (r"\(!busy\) && \(!dropping\)", "(!busy)"),
            (r"rst == 1\) begin\s+running", "0) begin running"),
            # A frame of one sample is never too short.
            *([(r"complete != in_last", "complete && !in_last")] if twin.inputs > 1 else []),
            *([STORED] if twin.results else []),
        ),
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
        faults=(
            (r"in_valid && closed", "in_valid && closed && in_last"),
            (r"halt && \(in_valid \|\| started\)", "halt && in_valid"),
            (r"dropping <= 1'b1", "dropping <= 1'b0"),
            (r"complete != in_last", "complete && !in_last"),
            (r"accept && complete && in_last", "accept && complete"),
            (r"closed \|\| halt \|\| dropping", "closed || dropping"),
            (r"closed \|\| halt \|\| dropping", "closed || halt"),
            (r"broken \|\| halt", "broken"),
            STORED,
        ),
        busy=("busy == computing", "!(start && halt)"),
    )


def judged(twin, watch, assumes, helps, *, stored, kinds, faults, busy=()):
    """The property of both, which says all that they do.

    watch: Says with ``ends_here`` which sample of a frame is the last one.
    stored: Whether a result is stored, behind the samples.
    kinds: Which frames are wrong.
    faults: Broken copies, besides those in which operands of both get wrong addresses.
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
        {ago("wrong_ago", "is_wrong", 1)}
        {ago("wrote_ago", f"(fits{stored})", 1)}
        // The program starts, and it runs until finish.
        wire opens_now = {"good_ago" if waits else "is_good"};
        reg going = 0;
        always @(posedge clk) going <= !rst && (opens_now || (going && !finish));
        // Operands of this frame before this clock; where one of a clock ago belongs.
        reg [{twin.addr_width - 1}:0] operands = 0;
        reg [{twin.addr_width - 1}:0] expected;
        always @(posedge clk) begin
            expected <= operands;
            if (fits{stored}) operands <= operands + 1;
            if (rst || finish || is_wrong && !computing || halt) operands <= 0;
        end
    """
    begun = ("running == computing", "going == computing")
    if waits:
        begun = (
            "running == going",
            "start == good_ago && waiting == good_ago",
            "computing == (going || good_ago) && !(going && good_ago)",
        )
    return [
        Property(
            name="good frames only",
            sentence=f"frame_error is high for exactly one clock for each frame that {kinds}. It "
            "comes one clock after what breaks the frame. "
            f"The program starts {'one clock after' if waits else 'with'} the last sample "
            "of a good frame, and in no other clock. It runs until the last output leaves or a "
            "reset comes. Each sample that is taken, and each result, is written to the operand "
            "memory one clock later. The first of a frame goes to address 0, and each other goes "
            f"behind the one before. A sample that breaks its frame may go to {top}.",
            states=(
                "frame_error == wrong_ago",
                "start == opens_now",
                "run == going",
                *busy,
                "write == wrote_ago",
                f"!write || write_addr == expected || (wrong_ago && write_addr == {top})",
            ),
            assumes=assumes,
            watch=watch,
            helps=(
                *begun,
                *helps,
                "dropping == spoiled",
                "!spoiled || inside",
                "!computing || (place == 0 && !inside) || spoiled",
                "!(spoiled || computing || !inside) || place == 0",
                "!inside || spoiled || place != 0",
                f"computing || addr == ((place + {top}) & {top})",
                f"addr == ((operands + {top}) & {top})",
                "!write || expected == addr || wrong_ago",
            ),
            reached=(
                *("frame_error", "spoiled && in_valid", "start", "run && in_valid"),
                "write && write_addr == 3" if stored else "write",
                *(("inside && halt && !spoiled",) if busy else ()),
            ),
            refuted_by=(
                *faults,
                (r"addr <= \(addr \+ 1\)", "addr <= (addr + 2)"),
                (r"finish \|\| broken", "finish"),
            ),
            whole=True,
        )
    ]


def image_loader(twin):
    addr, samples = twin.program_addr_width, twin.operand_addr_width
    last_part = WORD_BYTES - 1
    # Beyond any image that fits, words are not counted further.
    most = max(1000, twin.words + 2)
    low, bits = LAST_ADDR
    watch = f"""
        wire byte_taken = load_valid && !busy;
        // Whole words of this image so far, the header among them, and bytes of the next.
        reg [15:0] count = 0;
        reg [2:0] part = 0;
        reg [31:0] before;
        wire [39:0] together = {{before, load_data}};
        reg [39:0] header;
        reg [15:0] sum_before = {twin.check_start};
        reg [15:0] sum;
        reg image_is_good = 0, image_failed = 0, may_change = 1;
        reg [{samples - 1}:0] was;
        always @* begin
            sum = sum_before;
            {check_byte("load_data")}
        end
        wire [{bits}:0] words = header[{low + bits - 1}:{low}] + 1;
        wire room = words <= {twin.words};
        wire inside = count != 0 && room && count <= words;
        wire ends_good = count != 0 && room && count == words + 1 && part == 1 && sum == 0;
        always @(posedge clk) begin
            if (byte_taken) begin
                before <= together;
                sum_before <= load_last ? {twin.check_start} : sum;
                part <= load_last || part == {last_part} ? 0 : part + 1;
                if (load_last) count <= 0;
                else if (part == {last_part} && count != {most}) count <= count + 1;
                if (part == {last_part} && count == 0) header <= together;
                image_is_good <= load_last && ends_good;
                if (load_last) image_failed <= !ends_good;
            end
            was <= before_last;
            may_change <= halt || rst;
            if (rst) begin
                sum_before <= {twin.check_start};
                count <= 0;
                part <= 0;
                image_is_good <= 0;
                image_failed <= 0;
            end
        end
    """
    return [
        Property(
            name="good images only",
            sentence="halt ends with the last byte of an image that names no more words than the "
            "memory has, that has all of them and no byte more, and whose check is right. It "
            "begins with the first byte of the next image. No other image ends it, and image_error "
            "says so. Each word that the header names is written once, with its last byte, from "
            "the last address to address 0, unless the header names more words than the memory "
            "has. Nothing else is written, and nothing is written while busy is high. The number "
            "of samples of a frame is that of the header when an image is found good, and it "
            "changes only in clocks with halt.",
            states=(
                "halt == (byte_taken || !image_is_good)",
                "image_error == image_failed",
                f"write == (byte_taken && inside && part == {last_part})",
                f"!write || write_addr == ((words - count) & {(1 << addr) - 1})",
                f"!write || word == together[{WORD_WIDTH - 1}:0]",
                "load_ready == !busy && !(busy && write)",
                f"!ends_good || before_last == header[{17 + samples}:18]",
                "may_change || before_last == was",
            ),
            watch=watch,
            helps=(
                "check == sum_before",
                "whole == image_is_good",
                "failed == image_failed",
                "place == part",
                f"part <= {last_part} && count <= {most}",
                # The states are the header, the words, the check, and bytes that are too many.
                "count != 0 || (!headed && !ended)",
                f"!inside || (headed && !ended && addr == ((words - count) & {(1 << addr) - 1}))",
                "count == 0 || !room || count != words + 1 || (headed && ended)",
                "count == 0 || (room && count <= words + 1) || (!headed && ended)",
                "held == before[27:0]",
                f"count == 0 || !room || count > words + 1 || samples == header[{17 + samples}:18]",
            ),
            # Both may be anything, but must be the same.
            assumes={
                "Before the first byte, the register of bytes and its copy in the proof are "
                "equal.": "after_reset || held == before[27:0]"
            },
            reached=("count == 2 && byte_taken", "write"),
            refuted_by=(
                (r"check\[8-1:0\] == 0\)", "1'b1)"),
                (r"headed && ended && \(place == 1\)", "headed && ended"),
                (r"whole <= \(load_last && good\)", "whole <= good"),
                (rf"fits = \(named < {twin.words}\)", "fits = 1'b1"),
                (r"accept \|\| \(!whole\)", "!whole"),
                (rf"addr <= gathered\[{addr}-1:0\]", f"addr <= gathered[{addr + 1}-1:1]"),
                (r"full && headed && \(!ended\)", "full && (!ended)"),
                (rf"named < {twin.words}", f"named[17:{twin.words.bit_length()}] == 0"),
                (r"load_valid && \(!busy\)", "load_valid"),
                (r"held <= gathered\[28-1:0\]", "held <= {gathered[27:1], 1'b0}"),
                (r"samples <= gathered", "samples <= held"),
                (r"before_last = samples", "before_last = (samples ^ load_data)"),
            ),
            clocks=14,
            whole=True,
        )
    ]
