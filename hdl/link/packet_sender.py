"""packet_sender: sends what an instrument shows as packets, byte after byte."""

from myhdl import Signal, always, always_comb, always_seq, block, intbv, modbv

from golden.link.packet_sender import PacketSender
from golden.link.packets import CHECK_BYTES, CHECK_PRESET, COUNT_BYTES, FRAME, SYNC, kind_byte
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.check_byte import check_byte
from hdl.common.signals import Stream, fixed, flag, unsigned
from hdl.common.stream import next_point, position


@block
def keep_word(clk, rst, in_: Stream, count, word, *, slot: int):
    """``word`` is the latest element at position ``slot``, and 0 before the first one."""

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if in_.valid and count == slot:
            word.next = in_.data

    return keep


@block
def keep_frame(clk, rst, in_: Stream, words):
    """``words`` are the latest elements of a stream's frames, by position."""
    count = unsigned(len(words).bit_length())
    return (
        position(clk, rst, in_, count, stop=len(words)),
        [keep_word(clk, rst, in_, count, words[i], slot=i) for i in range(len(words))],
    )


@block
def keep_winner(clk, rst, winner: Stream, index, margin_high, margin_low):
    """Index and margin of the latest winner as bytes, and 0 before the first one."""
    width = len(winner.margin)
    margin = unsigned(width)

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if winner.valid:
            index.next = winner.index
            margin.next = winner.margin

    @always_comb
    def split():
        margin_low.next = margin[8:]
        margin_high.next = margin[width:8]

    return keep, split


@block
def keep_element(clk, rst, result: Stream, theta: Stream, *, shown, number, element, elements: int):
    """One element of theta, as it came last, and its number; behind a packet it is the next one.

    The elements come behind each frame, in their order.
    """
    final = elements - 1
    place, wanted = (unsigned(elements.bit_length()) for _ in range(2))

    @always_seq(clk.posedge, reset=rst)
    def count():
        if result.valid and result.last:
            place.next = 0
        elif theta.valid and place != elements:
            place.next = place + 1

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if theta.valid and place == wanted:
            number.next = place
            element.next = theta.data

    @always_seq(clk.posedge, reset=rst)
    def ask():
        if shown:
            if number == final:
                wanted.next = 0
            else:
                wanted.next = number + 1

    return count, keep, ask


@block
def since_packet(clk, rst, begins, event, told):
    """``told`` is high if ``event`` has come since the last packet, or comes in this clock."""
    seen = flag()

    @always_seq(clk.posedge, reset=rst)
    def remember():
        seen.next = told and not begins

    return ops.either(seen, event, told), remember


@block
def refused_frame(clk, rst, complete, frame_error, told, flag_out):
    """``flag_out`` tells that a frame was refused since the last packet or since the last frame."""
    refused = flag()

    @always_seq(clk.posedge, reset=rst)
    def remember():
        refused.next = not complete and (refused or frame_error)

    return remember, ops.either(told, refused, flag_out)


@block
def two_bytes(code, high, low):
    """``high`` and ``low`` are the bytes of a code in two's complement with 16 bits."""
    width, sign = SIGNAL.width, SIGNAL.width - 1
    above = width - 8

    @always_comb
    def split():
        low.next = code[8:]
        high.next = 0
        high.next[above:] = code[width:8]
        if code[sign]:
            high.next[8:above] = 3

    return split


@block
def stage(clk, *, begins, taken, fresh, following, here):
    """One byte of a shift register, which is loaded when a packet begins and moves by bytes."""

    @always(clk.posedge)
    def move():
        if begins:
            here.next = fresh
        elif taken:
            here.next = following

    return move


@block
def packet_sender(
    clk,
    rst,
    sample: Stream,
    result: Stream,
    out: Stream,
    *,
    converter_error,
    frame_error=None,
    image_error=None,
    line_error=None,
    lesson_error=None,
    learn_error=None,
    learning=None,
    winner: Stream = None,
    theta: Stream = None,
    profile=None,
    spec: PacketSender,
):
    """Frames of an instrument as packets, one whenever the line is free.

    Latency 2 clocks from the last output of a frame to the first byte. A packet has
    ``spec.layout.packet_bytes`` bytes. One goes without a new frame when the line has been free for
    ``spec.patience`` clocks. Reset forgets everything.
    """
    layout, last_wait = spec.layout, spec.patience - 1
    size = layout.packet_bytes
    final_place, check_place = size - 1, size - CHECK_BYTES
    preset = CHECK_PRESET
    samples = [fixed(SIGNAL) for _ in range(spec.inputs)]
    outputs = [fixed(SIGNAL) for _ in range(spec.outputs)]
    complete, free, begins, sending, taken = (flag() for _ in range(5))
    waited = unsigned(last_wait.bit_length())
    place = unsigned(final_place.bit_length())
    number = Signal(modbv(0, min=0, max=256))
    count = Signal(modbv(0, min=0, max=1 << 8 * COUNT_BYTES))
    flags = unsigned(8)
    check, following = Signal(intbv(preset, min=0, max=1 << 16)), unsigned(16)
    shown = unsigned(8)

    if spec.decides:

        @always_seq(clk.posedge, reset=rst)
        def note():
            complete.next = winner.valid
            if winner.valid:
                count.next = count + 1

    else:

        @always_seq(clk.posedge, reset=rst)
        def note():
            complete.next = result.valid and result.last
            if result.valid and result.last:
                count.next = count + 1

    @always_comb
    def look():
        free.next = out.ready and not sending
        taken.next = out.ready and sending

    @always_comb
    def decide():
        begins.next = free and (complete or waited == last_wait)

    @always_seq(clk.posedge, reset=rst)
    def wait_for_frame():
        if free and not begins:
            waited.next = waited + 1
        else:
            waited.next = 0

    @always_seq(clk.posedge, reset=rst)
    def step():
        if begins:
            sending.next = True
            place.next = 0
            number.next = number + 1
        elif taken:
            place.next = place + 1
            if place == final_place:
                sending.next = False
                place.next = 0

    @always_seq(clk.posedge, reset=rst)
    def follow_check():
        if taken:
            if place == 0:
                check.next = preset
            else:
                check.next = following

    parts = [
        note,
        look,
        decide,
        wait_for_frame,
        step,
        follow_check,
        check_byte(check, shown, following),
        keep_frame(clk, rst, sample, samples),
        keep_frame(clk, rst, result, outputs),
    ]
    if spec.reload:
        frames, images, lines, refused = (flag() for _ in range(4))

        @always_comb
        def tell():
            flags.next = 0
            flags.next[0] = converter_error
            flags.next[1] = refused
            flags.next[2] = images
            flags.next[3] = lines

        parts += [
            tell,
            since_packet(clk, rst, begins, frame_error, frames),
            since_packet(clk, rst, begins, image_error, images),
            since_packet(clk, rst, begins, line_error, lines),
            refused_frame(clk, rst, complete, frame_error, frames, refused),
        ]
    elif spec.learns:
        lines, lessons, steps = (flag() for _ in range(3))

        @always_comb
        def tell():
            flags.next = 0
            flags.next[0] = converter_error
            flags.next[3] = lines
            flags.next[4] = lessons
            flags.next[5] = steps
            flags.next[6] = learning

        parts += [
            tell,
            since_packet(clk, rst, begins, line_error, lines),
            since_packet(clk, rst, begins, lesson_error, lessons),
            since_packet(clk, rst, begins, learn_error, steps),
        ]
    else:

        @always_comb
        def tell():
            flags.next = 0
            flags.next[0] = converter_error

        parts.append(tell)

    high, low = unsigned(8), unsigned(8)

    @always_comb
    def split():
        high.next = count[16:8]
        low.next = count[8:]

    # The bytes of a packet up to the check, in the order of golden.link.packets.
    fresh = [SYNC, kind_byte(FRAME), layout.payload_bytes, number, flags, high, low]
    codes, learned, drawn, told = [*samples, *outputs], [], [], []
    if spec.points:
        point, x, y = unsigned(8), fixed(SIGNAL), fixed(SIGNAL)
        parts.append(
            next_point(clk, rst, profile, shown=begins, number=point, x=x, y=y, points=spec.points)
        )
        codes += [x, y]
        drawn = [point]
    if spec.learns:
        turn, element = unsigned(8), fixed(SIGNAL)
        parts.append(
            keep_element(
                clk,
                rst,
                result,
                theta,
                shown=begins,
                number=turn,
                element=element,
                elements=spec.elements,
            )
        )
        codes.insert(spec.inputs + spec.outputs, element)
        learned = [turn]
    halves = [(unsigned(8), unsigned(8)) for _ in codes]
    parts += [two_bytes(code, *pair) for code, pair in zip(codes, halves, strict=True)]
    words = [half for pair in halves for half in pair]
    if spec.decides:
        told = [unsigned(8) for _ in range(3)]
        parts.append(keep_winner(clk, rst, winner, *told))
    at, end = 2 * (spec.inputs + spec.outputs), len(words) - 4 * len(drawn)
    fresh += [*words[:at], *told, *learned, *words[at:end], *drawn, *words[end:]]
    line = [unsigned(8) for _ in fresh]
    parts += [
        stage(clk, begins=begins, taken=taken, fresh=new, following=behind, here=here)
        for new, here, behind in zip(fresh, line, [*line[1:], 0], strict=True)
    ]
    first = line[0]

    @always_comb
    def choose():
        if place >= check_place:
            shown.next = check[16:8]
        else:
            shown.next = first

    @always_comb
    def show():
        out.valid.next = sending
        out.data.next = shown

    return parts, split, choose, show
