"""The properties of image_receiver and lesson_receiver, for every stream of bytes."""

from golden.link.lesson_receiver import HEAD_BYTES
from golden.link.packets import CHECK_PRESET, IMAGE, LESSON, SYNC, kind_byte
from golden.numbers.precision import SIGNAL
from tb.common.properties import Property
from tb.common.watch import check_byte, since


def image_receiver(twin):
    depth, idle = twin.depth, twin.idle_clocks
    queue = {
        "While the engine computes, no more bytes come than are kept, as is proved of "
        "uart_instrument.": (f"!(put && queue0_stored == {depth} && !queue0_take)")
    }
    return [
        Property(
            name="bytes of an image",
            sentence=f"Behind SYNC, the byte of version and kind, and a length above 0, as many "
            "bytes as the length says go to the engine, the last of them with load_last. If no "
            f"byte comes for {idle} clocks, fewer go, and then a byte 0 with load_last. Nothing "
            "else goes there.",
            states=(
                "put == (left != 0 && (in_valid || silent))",
                "!put || ends == (silent || left == 1)",
                "!put || byte_in == (silent ? 0 : in_data)",
            ),
            watch=f"""
                // What is known of a head: SYNC, kind, half of the length.
                wire silent = idle == {idle - 1} && !in_valid;
                reg begun = 0, kind_known = 0, half_known = 0;
                reg [7:0] upper = 0;
                reg [15:0] left = 0;
                always @(posedge clk) begin
                    if (in_valid) begin
                        begun <= left == 0 && !kind_known && in_data == {SYNC};
                        kind_known <= (begun && in_data == {kind_byte(IMAGE)})
                            || (kind_known && !half_known);
                        half_known <= kind_known && !half_known;
                        upper <= in_data;
                        if (half_known) left <= {{upper, in_data}};
                        else if (left != 0) left <= left - 1;
                    end
                    if (silent) left <= 0;
                    if (rst || silent) begin
                        begun <= 0; kind_known <= 0; half_known <= 0;
                    end
                    if (rst) left <= 0;
                end
            """,
            helps=(
                "!(begun && kind_known)",
                "kind_known || !half_known",
                "left == 0 || !(begun || kind_known)",
                "(place == 0) == !(begun || kind_known || left != 0)",
                "(place == 1) == begun",
                "(place == 2) == (kind_known && !half_known)",
                "(place == 3) == half_known",
                "(place == 4) == (left != 0)",
                "left == 0 || length == left",
                "!half_known || length[7:0] == upper",
            ),
            # The property below says how long the line has been idle.
            free=("idle",),
            reached=("put",),
            refuted_by=(
                (r"in_data == 18", "in_data[3:0] == 2"),
                (r"named == 0", "named[7:0] == 0"),
                (r"over \|\| \(length == 1\)", "length == 1"),
                (r"length <= \(length - 1\)", "length <= length"),
                (r"byte_in = 0", "byte_in = 1"),
            ),
            clocks=9,
        ),
        silence(idle),
        Property(
            name="distance of bytes",
            sentence="Bytes that go to the engine are at least as far apart as those that come.",
            states=("!put || since_put >= apart",),
            # The distance may begin with any value.
            watch="reg [15:0] apart; always @(posedge clk) apart <= apart;"
            + since("since_in", "in_valid", "apart")
            + since("since_put", "put", "apart"),
            assumes={
                "Bytes come at least a certain number of clocks apart.": "!after_reset || "
                "!in_valid || since_in == apart",
                f"That number is at most {idle}.": f"apart > 0 && apart <= {idle}",
            },
            helps=(
                "since_in <= apart && since_put <= apart",
                "place == 0 || since_put >= since_in",
                "since_in == apart || since_in > idle",
            ),
            reached=("put && apart == 3",),
            refuted_by=((r"filling && \(in_valid \|\| over\)", "filling"),),
            clocks=14,
        ),
        Property(
            name="in order",
            sentence=f"The bytes for the engine leave in order, each with its load_last. None is "
            f"lost and none leaves twice. Each stays until it is taken, and at most {depth} wait.",
            states=(
                "load_valid == (puts != takes)",
                "!(load_valid && takes == chosen) || {load_last, load_data} == word",
            ),
            watch="""
                // Of any one byte, by its number, what it was.
                reg [7:0] chosen;
                reg [7:0] puts = 0, takes = 0;
                reg [8:0] word = 0;
                wire [7:0] before_it = chosen - takes;
                always @(posedge clk) begin
                    chosen <= chosen;
                    if (put) puts <= puts + 1;
                    if (put && puts == chosen) word <= entering;
                    if (load_valid && load_ready) takes <= takes + 1;
                    if (rst) begin puts <= 0; takes <= 0; end
                end
            """,
            helps=(
                f"queue0_stored <= {depth}",
                f"puts - takes == {{{8 - depth.bit_length()}'b0, queue0_stored}}",
                *(
                    f"!(before_it == {n} && queue0_stored > {n}) || {name} == word"
                    for n, name in enumerate(names(depth))
                ),
            ),
            free=("put", "entering"),
            assumes=queue,
            reached=("load_last", f"queue0_stored == {depth}"),
            refuted_by=(
                (r"queue0_some && load_ready", "queue0_some"),
                (r"queue0_behind \+ 1", "queue0_behind + 2"),
                (r"queue0_behind = \(queue0_stored - 1\)", "queue0_behind = queue0_stored"),
            ),
            clocks=depth + 6,
            whole=True,
        ),
    ]


def silence(idle):
    """Of images and of lessons."""
    return Property(
        name="silence",
        sentence="The clocks since the last byte are counted. A packet is over in exactly "
        f"those clocks in which no byte has come for {idle} clocks.",
        states=("idle == quiet", f"over == (quiet == {idle - 1} && !in_valid)"),
        watch=f"""
            reg [15:0] quiet = 0;
            always @(posedge clk)
                quiet <= rst || in_valid || quiet == {idle - 1} ? 0 : quiet + 1;
        """,
        helps=(f"quiet < {idle}",),
        refuted_by=(
            (r"idle <= \(idle \+ 1\)", "idle <= (idle + 2)"),
            (r"if \(\(in_valid \|\| over\)\)", "if (over)"),
        ),
        clocks=6,
    )


def names(depth):
    """The names of the words of the queue in the Verilog."""
    return ["queue0_first", *(f"queue0_queue_place{n}_following" for n in range(depth - 1))]


def lesson_receiver(twin):
    return [
        only_right_packets(twin),
        the_check(twin),
        silence(twin.idle_clocks),
        whole_frames(twin),
    ]


def only_right_packets(twin):
    end, bits = twin.packet_bytes - 1, HEAD_BYTES - 1
    return Property(
        name="only right packets",
        sentence="A packet counts in the clock of its last byte: behind SYNC, the byte of version "
        f"and kind and the length come {end - 2} bytes, none of them while codes leave, and the "
        f"check is right. No pause in it is {twin.idle_clocks} clocks long. Then learn becomes the "
        "lowest bit of its fourth byte, and target_theta the bit of theta. In no other clock does "
        "either change. Its codes, if it gives some, wait until a frame ends or the fourth byte of "
        "another packet comes. lesson_error is high one clock after a byte behind the length that "
        "comes while codes leave, a wrong length or check, and a pause behind the second byte.",
        states=(
            f"right == (in_valid && bytes == {end} && !sending && following == 0)",
            "learn == taught",
            "target_theta == told",
            "armed == waits",
            "lesson_error == was_wrong",
        ),
        watch=f"""
            reg [7:0] bytes = 0;
            reg bit_of = 0, taught = 0, theta_of = 0, told = 0, gives = 0, waits = 0, was_wrong = 0;
            wire silent = idle == {twin.idle_clocks - 1} && !in_valid;
            wire drops = in_valid && ((bytes == 2 && in_data != {twin.payload_bytes})
                || (bytes > 2 && sending) || bytes == {end});
            wire wrong_now = silent && bytes > 1
                || drops && !(bytes == {end} && following == 0);
            always @(posedge clk) begin
                was_wrong <= !rst && wrong_now;
                if (right) waits <= gives;
                else if (frame_end || in_valid && bytes == {bits}) waits <= 0;
                if (rst) waits <= 0;
                if (in_valid) begin
                    if (bytes == {bits}) gives <= in_data[1] || in_data[2];
                    if (bytes == {bits}) bit_of <= in_data[0];
                    if (bytes == {bits}) theta_of <= in_data[2];
                    if (bytes == 0) bytes <= in_data == {SYNC};
                    else if (bytes == 1)
                        bytes <= in_data == {kind_byte(LESSON)} ? 2 : in_data == {SYNC};
                    else bytes <= bytes + 1;
                    if (bytes == {end} && !sending && following == 0) taught <= bit_of;
                    if (bytes == {end} && !sending && following == 0) told <= theta_of;
                end
                if (silent || drops || rst) bytes <= 0;
                if (rst) taught <= 0;
                if (rst) told <= 0;
            end
        """,
        helps=(
            f"bytes == place && bytes <= {end}",
            f"bytes <= {bits} || (bit_of == learns && theta_of == puts && gives == knows)",
            f"!armed || bytes <= {bits}",
            f"!sending || bytes <= {bits + 1}",
        ),
        # The check and silence are proved below.
        free=("idle", "following"),
        reached=("right",),
        refuted_by=(
            (r"following == 0", "1"),
            (r"in_data == 19", "in_data[3:0] == 3"),
            (r"mode <= learns", "mode <= 1"),
            (r"putting <= puts", "putting <= 1"),
            (r"place == 2", "place == 3"),
            (r"armed <= knows", "armed <= 1"),
            (r"lesson_error <= wrong", "lesson_error <= refused"),
        ),
        clocks=twin.packet_bytes + 3,
    )


def the_check(twin):
    return Property(
        name="the check",
        sentence="What must be 0 in the clock of the last byte is the CRC of all bytes behind "
        "SYNC, computed bit by bit.",
        states=("!(in_valid && place > 0) || following == sum",),
        watch=f"""
            reg [15:0] summed = 0, sum;
            always @* begin
                sum = place == 1 ? {CHECK_PRESET} : summed;
                {check_byte("in_data")}
            end
            always @(posedge clk) if (in_valid) summed <= sum;
        """,
        helps=(f"place == 0 || check == (place == 1 ? {CHECK_PRESET} : summed)",),
        free=("idle", "sending"),
        reached=("place == 4",),
        refuted_by=((r"check <= 65535;(?=\s+end\s+else begin\s+check)", "check <= 0;"),),
        clocks=6,
    )


def whole_frames(twin):
    count = f"(target_theta ? {twin.elements} : {twin.outputs})"
    words = ["first", *(f"known_word{n}_following" for n in range(twin.codes - 1))]
    low = f"{HEAD_BYTES + 1} + 2 * chosen"
    places = (
        # Codes enter behind the last one and move up, wait, and leave in front.
        (f"place > {low}", f"{twin.codes} - (place - {HEAD_BYTES}) / 2 + chosen"),
        ("armed", "chosen"),
        ("sending && chosen >= count", "chosen - count"),
    )
    return Property(
        name="whole frames of codes",
        sentence="Codes begin to leave only in the clock after frame_end, and only those of a "
        f"packet that was right before. {twin.outputs} known outputs leave or {twin.elements} "
        "elements of theta, one after the other, the last one with target_last. Each stays until "
        "it is taken, and so does target_theta. Each code that leaves is made of the two bytes at "
        f"its place in the packet: the lowest {SIGNAL.width - 8} bits of the first, and the "
        "second.",
        states=(
            "target_valid == (left != 0)",
            "!target_valid || target_last == (left == 1)",
            "!stood || (target_valid && target_data == before)",
            "!went || target_theta == kind_before",
            "!armed || packets",
            "!target_valid || chosen != count || target_data == code",
        ),
        watch=f"""
            // Of any one code, by its number, what it was.
            (* anyconst *) reg [3:0] chosen;
            reg [7:0] upper = 0;
            reg signed [{SIGNAL.width - 1}:0] code;
            reg [7:0] left = 0;
            reg stood = 0, packets = 0, went = 0, kind_before = 0;
            reg [13:0] before = 0;
            always @(posedge clk) begin
                if (in_valid) upper <= in_data;
                if (in_valid && place == {low}) code <= {{upper[{SIGNAL.width - 9}:0], in_data}};
                if (frame_end && armed) left <= {count};
                else if (target_ready && left != 0) left <= left - 1;
                stood <= !rst && target_valid && !target_ready;
                before <= target_data;
                went <= !rst && target_valid && !target_last;
                kind_before <= target_theta;
                packets <= !rst && (packets || right);
                if (rst) left <= 0;
            end
        """,
        helps=(
            f"left <= {count} && (left == 0 ? count == 0 : count == {count} - left)",
            "!(sending && armed)",
            f"!armed || place <= {HEAD_BYTES - 1}",
            f"!sending || place <= {HEAD_BYTES}",
            f"place <= {twin.packet_bytes - 1}",
            f"place == 0 || high == upper[{SIGNAL.width - 9}:0]",
            *(
                f"!(chosen < {twin.codes} && {when} && {at} == {n}) || {word} == code"
                for when, at in places
                for n, word in enumerate(words)
            ),
        ),
        free=("idle", "following"),
        reached=("target_valid && target_last", "target_valid && chosen == count && count == 1"),
        refuted_by=(
            (r"frame_end && armed", "armed"),
            (r"place >= 3", "place >= 9"),
            (r"sending && target_ready", "sending"),
            (r"count == \d+", "count == 0"),
            (r"known_word1_following <= \w+;", "known_word1_following <= 0;"),
            (r"odd = place\[0\]", "odd = (!place[0])"),
            (r"place < \d+", "place < 9"),
        ),
        clocks=twin.packet_bytes + 8,
        whole=True,
    )
