"""Proved properties of uart_instrument: how its parts work together, for any line and converter.

The first properties are of an engine that takes images. Without a line that is heard they are those
of converter_instrument. That the densities give the points of a profile one after the other stands
in packet_proof.py. At the end stand those of the line's receiver and transmitter, and of the pulse
density. What a sender with lessons or with index and margin tells is not proved: the bench
compares every bit of ``tx``.
"""

from golden.link.uart import BYTE_BITS
from tb.common.properties import Property
from tb.common.watch import busy_of, since
from tb.instruments import tb_converter_instrument
from tb.link.packet_proof import packet_sender, slow_points
from tb.link.receiver_proof import image_receiver, lesson_receiver

PROVED = ("plain-uart", "learn-uart")
SENDER, TRANSMITTER, RECEIVER = "u_packet_sender_0", "u_uart_transmitter_0", "u_image_receiver_0"


def properties(twin):
    if twin.learns:
        return [rests(twin)]
    found = [slow_points(twin.packet_sender.points)] if twin.analogue else []
    if not twin.reload:
        return [*tb_converter_instrument.properties(twin), *found]
    engine = f"u_readout_0.u_{twin.core.entity}_0"
    return [no_half_image(twin, engine), room(twin, engine), rests(twin), *found]


def no_half_image(twin, engine):
    loader = f"{engine}.u_image_loader_0"
    return Property(
        name="no half image",
        sentence="A frame starts, and is computed, only while the last byte that the engine took "
        "was the last byte of an image. After a reset no frame starts before such a byte has come.",
        states=(f"!({engine}.start || {engine}.run) || ended",),
        watch="""
            reg ended = 0;
            always @(posedge clk)
                ended <= !rst && (load_valid && load_ready ? load_last : ended);
        """,
        helps=(f"!{loader}.whole || ended", *busy_of(twin.core, f"{engine}.")),
        # The program in the memory and the check of an image may be anything.
        free=(*("valid", "last", "heard_valid", "heard"), *(f"{engine}.word", f"{loader}.good")),
        reached=(f"{engine}.start",),
        refuted_by=(
            (r"(?s)(frame_guard u_frame_guard_0 .*?\.halt)\(halt\)", r"\1(1'b0)"),
            (r"\.busy\(busy\)", ".busy(1'b0)"),
            (r"accept \|\| \(!whole\)", "!whole"),
            (r"whole <= \(load_last && good\)", "whole <= good"),
            (r"(?s)(image_loader u_image_loader_0 .*?\.rst)\(rst\)", r"\1(1'b0)"),
        ),
        clocks=18,
    )


def room(twin, engine):
    depth, apart = twin.image_receiver.depth, twin.uart_receiver.interval
    longest = 1 << twin.core.loaded.sizes.program_addr_width
    # With registers behind the memories the program starts one clock after its frame is taken.
    begins = "start" if twin.core.frame_guard.pipeline.run == 1 else "u_frame_guard_0.good"
    return Property(
        name="room for bytes",
        sentence=f"Bytes for the engine wait only while a frame is computed, and no frame starts "
        f"while a byte waits. So fewer than {depth} bytes wait, and there is room for them.",
        states=(
            f"{RECEIVER}.queue0_stored == 0 || {engine}.busy || {RECEIVER}.queue0_take",
            f"!{engine}.{begins} || {RECEIVER}.queue0_stored == 0",
            f"{RECEIVER}.queue0_stored < {depth}",
        ),
        # The frame itself takes these clocks as well.
        watch=since("since_put", f"{RECEIVER}.put", apart)
        + f"""
            reg [15:0] computing = 0;
            always @(posedge clk) computing <= {engine}.busy ? computing + 1 : 0;
        """,
        assumes={
            f"Bytes come at least {apart} clocks apart, as is proved of uart_receiver and "
            "image_receiver.": (f"!({RECEIVER}.put && since_put != {apart})"),
            f"A program ends within {longest} clocks, as many as its memory has words.": (
                f"computing < {longest}"
            ),
        },
        helps=(
            f"since_put >= 1 && since_put <= {apart}",
            f"!{engine}.busy || {RECEIVER}.queue0_stored == 0 "
            f"|| ({RECEIVER}.queue0_stored - 1) * {apart} + since_put <= computing + 1",
        ),
        # Any result may be computed, and an image may be good in any clock.
        free=(
            *("valid", "last", f"{RECEIVER}.put", f"{RECEIVER}.entering"),
            *(f"{engine}.word", f"{engine}.u_image_loader_0.whole"),
        ),
        reached=(f"{RECEIVER}.queue0_stored == 1 && {engine}.busy",),
        refuted_by=(
            (r"(?s)(image_receiver u_.*?\.load_ready)\(load_ready\)", r"\1(1'b0)"),
            (r"accept \|\| \(!whole\)", "!whole"),
        ),
        clocks=10,
    )


def rests(twin):
    patience = twin.packet_sender.patience
    ones = f"{BYTE_BITS}'d{(1 << BYTE_BITS) - 1}"
    return Property(
        name="line at rest",
        sentence="Each byte of a packet is taken by the line, one after the other. After a reset "
        f"tx stays 1 until a frame has left, or for {patience} clocks.",
        states=(f"{SENDER}.taken == {TRANSMITTER}.accept", f"tx || left_one || age > {patience}"),
        watch=f"""
            // Whether a frame has left since a reset, and clocks since then.
            reg left_one = 0;
            reg [31:0] age = 0;
            always @(posedge clk) begin
                left_one <= !rst && (left_one || (out_valid && out_last));
                age <= rst ? 0 : age > {patience} ? age : age + 1;
            end
        """,
        helps=(
            f"age <= {patience + 1}",
            f"{SENDER}.waited <= age && {SENDER}.waited < {patience}",
            f"!{SENDER}.complete || left_one",
            f"!{SENDER}.sending || left_one || age >= {patience}",
            f"{TRANSMITTER}.left == 0 || left_one || age > {patience}",
            f"{TRANSMITTER}.left != 0 || {TRANSMITTER}.tick == 0",
            # Ones are shifted in behind the bits that are left.
            f"{TRANSMITTER}.left <= {BYTE_BITS}",
            f"&({TRANSMITTER}.line | ~({ones} << {TRANSMITTER}.left))",
        ),
        free=("result_valid", "result_last", "byte_data"),
        reached=("!tx",),
        refuted_by=(
            (r"\.in_valid\(byte_valid\)", ".in_valid(1'b1)"),
            (r"\.out_ready\(byte_ready\)", ".out_ready(1'b1)"),
            (r"\.result_last\(result_last\)", ".result_last(result_valid)"),
        ),
        clocks=12,
    )


def uart_receiver(twin):
    bit, half, stop = twin.divisor, twin.divisor // 2, twin.stop_clocks
    return [
        Property(
            name="bytes",
            sentence=f"Where the line falls while no byte is under way, it is read {half} clocks "
            "later, and the byte ends there if the line is 1. If the line is 0, it is read every "
            f"{bit} clocks from then on, nine times, and the byte ends with the last reading. The "
            "line is read at no other time. "
            "One clock after the last of these readings, at the stop bit, out_valid is "
            "high if the line was 1, and out_data are the eight bits before it, the lowest first. "
            "If the line was 0, line_error is high. Neither is high in any other clock. "
            f"From one byte to the next there are at least {twin.interval} clocks.",
            states=(
                "running == (ahead != 0)",
                "sample == (ahead == 1)",
                "out_valid == good",
                "line_error == bad",
                "!good || out_data == bits",
                f"!out_valid || apart >= {twin.interval}",
            ),
            watch=f"""
                // The line one, two and three clocks ago; clocks to the next look at it, 0 for
                // none, and looks that were taken.
                reg one = 1, two = 1, three = 1;
                reg [7:0] ahead = 0;
                reg [3:0] looks = 0;
                reg good = 0, bad = 0;
                reg [7:0] bits = 0;
                wire last = ahead == 1 && looks == 9;
                always @(posedge clk) begin
                    one <= rx;
                    two <= one;
                    three <= two;
                    good <= !rst && last && two;
                    bad <= !rst && last && !two;
                    if (ahead == 1 && looks != 9) bits <= {{two, bits[7:1]}};
                    if (ahead == 0) begin
                        ahead <= three && !two ? {half} : 0;
                        looks <= 0;
                    end else if (ahead == 1) begin
                        ahead <= looks == 9 || (looks == 0 && two) ? 0 : {bit};
                        looks <= looks + 1;
                    end else ahead <= ahead - 1;
                    if (rst) begin
                        one <= 1;
                        two <= 1;
                        three <= 1;
                        ahead <= 0;
                    end
                end
                // Clocks of the byte under way so far.
                wire [7:0] age = ahead == 0 ? 0 : {half + 1} + {bit} * looks - ahead;
            """
            + since("apart", "out_valid", twin.interval),
            helps=(
                f"ahead <= {bit}",
                "looks <= 9 || ahead == 0",
                f"ahead == 0 || looks != 0 || ahead <= {half}",
                "raised == one",
                "line == two",
                "earlier == three",
                f"ahead == 0 || tick == {bit} - ahead",
                "ahead == 0 || place == looks",
                "ahead == 0 || ((kept ^ bits) >> (looks > 8 ? 0 : 8 - looks)) == 0",
                f"apart <= {twin.interval}",
                "out_valid || apart >= age",
                "!out_valid || ahead == 0",
            ),
            reached=("out_valid", "line_error"),
            whole=True,
            refuted_by=(
                (r"earlier && \(!line\)", "earlier"),
                (r"earlier && \(!line\)", "(!line)"),
                (rf"tick <= {bit - half};", "tick <= 0;"),
                (rf"tick == {bit - 1}", f"tick == {bit - 2}"),
                (r"\(place == 0\) && line", "(place == 0) && 0"),
                (r"\(place == 0\) && line", "line"),
                (r"out_valid <= \(ends && line\)", "out_valid <= ends"),
                (r"out_valid <= \(ends && line\)", "out_valid <= (sample && line)"),
                (r"place == 9", "place == 8"),
                (r"\{line, kept", "{earlier, kept"),
            ),
            clocks=stop + 8,
        )
    ]


def uart_transmitter(twin):
    bit, whole = twin.divisor, twin.interval
    return [
        Property(
            name="bits of a byte",
            sentence=f"From one clock after a byte is taken, tx is 0 for {bit} clocks, then each "
            f"bit of the byte for {bit} clocks, the lowest first, and then 1 for {bit} clocks. "
            "Without a byte, and after a reset, tx is 1. The next byte is taken in the last clock "
            "of the stop bit, or later.",
            states=(
                "tx == (age == IDLE || all_bits[age / BIT])",
                "in_ready == (age == IDLE || age == IDLE - 1)",
            ),
            watch=f"""
                localparam [15:0] BIT = {bit}, IDLE = {whole};
                // Clocks since the start bit began.
                reg [15:0] age = IDLE;
                reg [7:0] taken = 0;
                wire [{BYTE_BITS - 1}:0] all_bits = {{1'b1, taken, 1'b0}};
                wire [{2 * BYTE_BITS - 1}:0] moved = {{{{{BYTE_BITS}{{1'b1}}}}, all_bits}}
                    >> (age / BIT);
                always @(posedge clk) begin
                    if (in_valid && in_ready) taken <= in_data;
                    age <= in_valid && in_ready ? 0 : age == IDLE ? IDLE : age + 1;
                    if (rst) age <= IDLE;
                end
            """,
            helps=(
                "age <= IDLE",
                f"left == (age == IDLE ? 0 : {BYTE_BITS} - age / BIT)",
                "tick == (age == IDLE ? 0 : age % BIT)",
                f"line == (age == IDLE ? {(1 << BYTE_BITS) - 1} : moved[{BYTE_BITS - 1}:0])",
            ),
            reached=("age == IDLE - 1",),
            whole=True,
            refuted_by=(
                (r"tick == \d+", "tick == 0"),
                (r"\(left == 1\) && ends", "(left == 1)"),
                (r"\{1'b1, in_data, 1'b0\}", "{1'b1, ~in_data, 1'b0}"),
                (r"\{1'b1, line", "{1'b0, line"),
            ),
            clocks=whole + 6,
        )
    ]


def pulse_density(twin):
    width, low = twin.fmt.width, -twin.fmt.low
    return [
        Property(
            name="as many ones as are asked for",
            sentence=f"The sum of all codes since a reset, each increased by {low}, is 2^{width} "
            "times the number of ones that were given, plus a remainder that is smaller than "
            f"2^{width}.",
            states=("asked_for == {ones + {31'b0, out_bit}, remainder}",),
            watch=f"""
                // Modulo 2^{32 + width}.
                reg [{31 + width}:0] asked_for = 0;
                reg [31:0] ones = 0;
                wire [{width - 1}:0] above_low = in_data + {low};
                always @(posedge clk) begin
                    asked_for <= rst ? 0 : asked_for + {{32'b0, above_low}};
                    ones <= rst ? 0 : ones + {{31'b0, out_bit}};
                end
            """,
            reached=("out_bit",),
            whole=True,
            refuted_by=(
                (r"asked\[13\] = \(!in_data\[13\]\)", "asked[13] = in_data[13]"),
                (r"given <= total\[14\]", "given <= total[13]"),
            ),
        )
    ]


OF_PARTS = {
    "image_receiver": image_receiver,
    "lesson_receiver": lesson_receiver,
    "packet_sender": packet_sender,
    "uart_receiver": uart_receiver,
    "uart_transmitter": uart_transmitter,
    "pulse_density": pulse_density,
}
