"""The properties of image_receiver, a part of uart_instrument, for every stream of bytes."""

from golden.link.packets import IMAGE, SYNC, kind_byte
from tb.common.properties import Property
from tb.common.watch import since


def image_receiver(twin):
    """The properties of the part, which say all that it does."""
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
