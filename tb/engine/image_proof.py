"""The properties of image_loader, a part of engine, for every stream of bytes."""

from golden.engine.formats import WORD_WIDTH
from golden.engine.image import LAST_ADDR, WORD_BYTES
from tb.common.properties import Property
from tb.common.watch import check_byte


def image_loader(twin):
    """The properties of the part, which say all that it does."""
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
        reg image_is_good = 0, image_failed = 0;
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
            if (rst) begin
                sum_before <= {twin.check_start};
                count <= 0;
                part <= 0;
                image_is_good <= 0;
                image_failed <= 0;
            end
        end
    """
    helps = (
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
    )
    # Both may be anything, but must be the same.
    same = {
        "Before the first byte, the register of bytes and its copy in the proof are equal.": (
            "after_reset || held == before[27:0]"
        )
    }
    return [
        Property(
            name="good images only",
            sentence="halt ends with the last byte of an image that names no more words than the "
            "memory has, that has all of them and no byte more, and whose check is right. It "
            "begins with the first byte of the next image. No other image ends it, and image_error "
            "says so.",
            states=("halt == (byte_taken || !image_is_good)", "image_error == image_failed"),
            watch=watch,
            helps=helps,
            assumes=same,
            reached=("count == 2 && byte_taken",),
            refuted_by=(
                (r"check\[8-1:0\] == 0\)", "1'b1)"),
                (r"headed && ended && \(place == 1\)", "headed && ended"),
                (r"whole <= \(load_last && good\)", "whole <= good"),
                (rf"fits = \(named < {twin.words}\)", "fits = 1'b1"),
                (r"accept \|\| \(!whole\)", "!whole"),
            ),
            clocks=14,
        ),
        Property(
            name="words in order",
            sentence="Each word that the header names is written once, with its last byte, from "
            "the last address to address 0, unless the header names more words than the memory "
            "has. Nothing else is written, and nothing is written while busy is high.",
            states=(
                f"write == (byte_taken && inside && part == {last_part})",
                f"!write || write_addr == ((words - count) & {(1 << addr) - 1})",
                f"!write || word == together[{WORD_WIDTH - 1}:0]",
                "load_ready == !busy && !(busy && write)",
            ),
            watch=watch,
            helps=helps,
            assumes=same,
            reached=("write",),
            refuted_by=(
                (rf"addr <= gathered\[{addr}-1:0\]", f"addr <= gathered[{addr + 1}-1:1]"),
                (r"full && headed && \(!ended\)", "full && (!ended)"),
                (rf"named < {twin.words}", f"named[17:{twin.words.bit_length()}] == 0"),
                (r"load_valid && \(!busy\)", "load_valid"),
                (r"held <= gathered\[28-1:0\]", "held <= {gathered[27:1], 1'b0}"),
            ),
            clocks=11,
        ),
        Property(
            name="length stays",
            sentence="The number of samples of a frame is that of the header when an image is "
            "found good, and it changes only in clocks with halt.",
            states=(f"!ends_good || before_last == header[{17 + samples}:18]", "steady"),
            watch=watch
            + f"""
                reg [{samples - 1}:0] was;
                reg may_change = 1;
                always @(posedge clk) begin
                    was <= before_last;
                    may_change <= halt || rst;
                end
                wire steady = may_change || before_last == was;
            """,
            helps=helps,
            assumes=same,
            reached=("count == 1",),
            refuted_by=(
                (r"samples <= gathered", "samples <= held"),
                (r"before_last = samples", "before_last = (samples ^ load_data)"),
            ),
            clocks=13,
            whole=True,
        ),
    ]
