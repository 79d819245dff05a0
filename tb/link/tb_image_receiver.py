"""image_receiver against its twin: images among cut ones, packets of other kinds, and noise.

Bytes come at random clocks and back to back, while the engine takes as few as the block can keep,
and with resets. Every image that was sent completely arrives.
"""

import cocotb
import numpy as np

from golden.link.packets import FRAME, IMAGE, MOST_IMAGE, SYNC, VERSION, image_packet, kind_byte
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import UART
from tb.common.properties import Property
from tb.common.stimulus import random_resets
from tb.common.watch import since

CASES = {"uart": UART}
LONG = 0xA9D6
WATCH = ["load_valid", "load_data", "load_last"]


def timeline(bench, packets):
    """The columns of bytes. A packet is its data, their spacing, and the idle clocks after it.

    With a spacing of 0 the first bytes come back to back, while the engine takes none.
    """
    twin, rng = bench.twin, bench.rng
    valid, data, ready = [], [], []

    def wait(clocks, takes=None):
        valid.extend([0] * clocks)
        data.extend(rng.integers(0, 256, clocks).tolist())
        ready.extend(rng.integers(0, 2, clocks).tolist() if takes is None else [takes] * clocks)

    for sent, spacing, idle in packets:
        for place, byte in enumerate(sent):
            # The first bytes of an image come after the four bytes of its head.
            holds = spacing == 0 and place < 4 + twin.depth
            valid.append(1)
            data.append(byte)
            ready.append(0 if holds else 1)
            if not holds:
                wait(int(rng.integers(0, spacing + 1)), takes=1)
            if spacing == 0 and place == 4 + twin.depth - 1:
                wait(5, takes=0)
                wait(2 * twin.depth, takes=1)
        wait(3, takes=1)
        wait(idle)
    columns = {"in_valid": valid, "in_data": data, "load_ready": ready}
    return {name: np.array(column, dtype=np.int64) for name, column in columns.items()}


async def check(bench, drive):
    """Compare every clock, and return the bytes that left and which of them were last."""
    recording = await bench.play(drive, WATCH)
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("in_valid", "in_data", "load_ready", "rst")
    seen = {name: recording.unsigned(name, rows) for name in names}
    expected = bench.twin.process(*seen.values())
    offered = rows[expected.load_valid]
    bench.compare("clocks of load_valid", recording.rows("load_valid"), offered)
    for port in ("load_data", "load_last"):
        got = recording.unsigned(port, offered)
        bench.compare(port, got, getattr(expected, port)[expected.load_valid], clock=offered)
    places, kept = bench.twin.states
    over = np.flatnonzero(idle_ends(seen["in_valid"], seen["rst"], bench.twin.idle_clocks))
    bench.visit(places, expected.place[over])
    bench.visit(kept, expected.stored)
    taken = np.intersect1d(offered, rows[seen["load_ready"] == 1])
    return recording.unsigned("load_data", taken), recording.unsigned("load_last", taken)


def idle_ends(valid, clears, clocks):
    """The clocks in which the line has been idle for just ``clocks`` clocks."""
    found, idle = np.zeros(len(valid), dtype=bool), 0
    for t, (comes, cleared) in enumerate(zip(valid, clears, strict=True)):
        found[t] = not (comes or cleared) and idle == clocks - 1
        idle = 0 if comes or cleared or found[t] else idle + 1
    return found


def whole_packet(rng, most):
    return image_packet(rng.integers(0, 256, int(rng.integers(1, most))).astype(np.uint8).tobytes())


@cocotb.test()
async def images_among_others(dut):
    """Play images, and between them other bytes. After a cut image comes a last byte 0."""
    bench = Bench(dut)
    twin, rng = bench.twin, bench.rng
    idle = twin.idle_clocks + 10
    packets, due = [], []

    def send(data, spacing, image=None, behind=0):
        packets.append((data, spacing, behind))
        if image is not None:
            due.append(image)

    noise = rng.choice([SYNC, kind_byte(FRAME), 0, 7], 60)
    send(noise.astype(np.uint8).tobytes(), 3)
    for other in (kind_byte(FRAME), kind_byte(IMAGE, VERSION + 1), kind_byte(3)):
        send(bytes([SYNC, other, 0, 3, 1, 2, 3]), 2)
    for bit in range(8):
        send(bytes([SYNC, kind_byte(IMAGE) ^ 1 << bit, 0, 3, 1, 2, 3]), 2)
    # After a length of 0, a packet begins with another SYNC.
    send(bytes([SYNC, kind_byte(IMAGE), 0, 0, kind_byte(IMAGE), 0, 3, 1, 2, 3]), 2)
    for size in (1, 2, 3, 255, 256, 257, 600):
        image = rng.integers(0, 256, size).astype(np.uint8).tobytes()
        # A head after a further SYNC is a valid head.
        send(bytes([SYNC]) * (size % 2) + image_packet(image), 3 * (size < 5), image)
    for cut in (1, 2, 3, 4, 5, 30):
        packet = image_packet(rng.integers(1, 256, 60).astype(np.uint8).tobytes())[:cut]
        send(packet, 4, packet[4:] + b"\0" if cut > 3 else None, behind=idle)
        image = rng.integers(0, 256, 2 * twin.depth).astype(np.uint8).tobytes()
        send(image_packet(image), 0 if cut % 2 else 5, image, behind=idle if cut == 30 else 0)
    # Images wait in the queue, so that the last byte gets to each of its places.
    for size in range(1, twin.depth + 1):
        image = rng.integers(0, 256, size).astype(np.uint8).tobytes()
        send(image_packet(image), 0, image, behind=8 * twin.depth)
    # Each bit of the length is 1 in one of these lengths and 0 in the other.
    for size in (LONG, MOST_IMAGE ^ LONG):
        image = rng.integers(0, 256, size).astype(np.uint8).tobytes()
        send(image_packet(image), 0, image)
    data, last = await check(bench, timeline(bench, packets))
    bench.compare("bytes of the images", data, np.frombuffer(b"".join(due), np.uint8))
    ends = np.cumsum([len(image) for image in due]) - 1
    bench.compare("their ends", np.flatnonzero(last), ends)
    bench.finish(at_least=1500)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    rng = bench.rng
    packets = [(whole_packet(rng, 60), int(rng.integers(0, 4)), 0) for _ in range(60)]
    drive = timeline(bench, packets)
    drive["rst"] = random_resets(rng, len(drive["in_valid"]), 60)
    await check(bench, drive)
    bench.finish(at_least=300)


def properties(twin):
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
        Property(
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
        ),
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
        ),
    ]


def names(depth):
    """The names of the words of the queue in the Verilog."""
    return ["queue0_first", *(f"queue0_queue_place{n}_following" for n in range(depth - 1))]
