"""lesson_receiver: takes known outputs, theta, and whether to learn, out of bytes of a line."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, intbv

from golden.link.lesson_receiver import HEAD_BYTES, LessonReceiver
from golden.link.packets import CHECK_PRESET, LESSON, SYNC, kind_byte
from golden.numbers.precision import SIGNAL
from hdl.common.check_byte import check_byte
from hdl.common.signals import Stream, fixed, flag, unsigned


@block
def known_word(clk, moves, following, here):
    """One code; all move up when one comes in behind the last or leaves in front."""

    @always(clk.posedge)
    def move():
        if moves:
            here.next = following

    return move


@block
def lesson_receiver(
    clk, rst, in_: Stream, target: Stream, *, frame_end, learn, lesson_error, spec: LessonReceiver
):
    """Finds the packets of lessons among bytes, and hands their codes on behind a frame.

    Latency 1 clock from the end of a frame to the first code. A packet in which no byte
    comes for ``spec.idle_clocks`` clocks is dropped. Reset forgets what has come.
    """
    sync, kind, length = SYNC, kind_byte(LESSON), spec.payload_bytes
    final, end, code_end = spec.idle_clocks - 1, spec.packet_bytes - 1, spec.packet_bytes - 2
    bits_place, first_code = HEAD_BYTES - 1, HEAD_BYTES
    preset, last_known, last_theta = CHECK_PRESET, spec.outputs - 1, spec.elements - 1
    above = SIGNAL.width - 8
    place, idle = unsigned(end.bit_length()), unsigned(max(1, final.bit_length()))
    check, following = Signal(intbv(preset, min=0, max=1 << 16)), unsigned(16)
    over, refused, whole, right, wrong = (flag() for _ in range(5))
    of_kind, of_length, odd = flag(), flag(), flag()
    learns, knows, puts, armed, sending, leaves, final_leaves, mode = (flag() for _ in range(8))
    putting, at_last = flag(), flag()
    count = unsigned(max(1, (spec.codes - 1).bit_length()))
    high = unsigned(above)
    entering = fixed(SIGNAL)
    enters, moves = flag(), flag()
    words = [fixed(SIGNAL) for _ in range(spec.codes)]
    first = words[0]

    @always_comb
    def look():
        over.next = idle == final and not in_.valid
        of_kind.next = in_.data == kind
        of_length.next = in_.data == length

    # While codes leave, no packet comes further than to the byte behind its bits.
    @always_comb
    def judge():
        refused.next = in_.valid and (
            (place == 2 and not of_length) or (place >= bits_place and sending)
        )
        whole.next = in_.valid and place == end

    @always_comb
    def decide():
        right.next = whole and following == 0
        wrong.next = refused or (whole and following != 0) or (over and place > 1)

    @always_seq(clk.posedge, reset=rst)
    def wait_for_byte():
        if in_.valid or over:
            idle.next = 0
        else:
            idle.next = idle + 1

    @always_seq(clk.posedge, reset=rst)
    def step():
        if over or refused or whole:
            place.next = 0
        elif in_.valid:
            if place == 0:
                if in_.data == sync:
                    place.next = 1
            elif place == 1:
                if of_kind:
                    place.next = 2
                elif in_.data != sync:
                    place.next = 0
            else:
                place.next = place + 1

    @always_seq(clk.posedge, reset=rst)
    def follow_check():
        if in_.valid:
            if place == 0 or (place == 1 and not of_kind):
                check.next = preset
            else:
                check.next = following

    @always_seq(clk.posedge, reset=rst)
    def tell():
        lesson_error.next = wrong

    # The bits count when the check was right.
    @always(clk.posedge)
    def keep():
        if in_.valid:
            high.next = in_.data[above:]
            if place == bits_place:
                learns.next = in_.data[0]
                knows.next = in_.data[1] or in_.data[2]
                puts.next = in_.data[2]

    @always_seq(clk.posedge, reset=rst)
    def obey():
        if right:
            mode.next = learns
            putting.next = puts

    @always_comb
    def join():
        entering.next = concat(high, in_.data).signed()
        odd.next = place[0]

    # The high byte of a code stands at an even place, and its low byte at an odd one.
    @always_comb
    def enter():
        enters.next = in_.valid and odd and place > first_code and place < code_end
        leaves.next = sending and target.ready

    @always_comb
    def find():
        if putting:
            at_last.next = count == last_theta
        else:
            at_last.next = count == last_known

    @always_comb
    def shift():
        moves.next = enters or leaves
        final_leaves.next = leaves and at_last

    @always_seq(clk.posedge, reset=rst)
    def arm():
        if right:
            armed.next = knows
        elif frame_end or (in_.valid and place == bits_place):
            armed.next = False

    @always_seq(clk.posedge, reset=rst)
    def send():
        if frame_end and armed:
            sending.next = True
        elif final_leaves:
            sending.next = False

    @always_seq(clk.posedge, reset=rst)
    def number():
        if final_leaves:
            count.next = 0
        elif leaves:
            count.next = count + 1

    @always_comb
    def show():
        target.valid.next = sending
        target.data.next = first
        target.last.next = at_last
        target.theta.next = putting
        learn.next = mode

    return (
        *(look, judge, decide, wait_for_byte, step, follow_check, tell, keep, obey),
        *(join, enter, find, shift, arm, send, number, show),
        check_byte(check, in_.data, following),
        [
            known_word(clk, moves, behind, here)
            for here, behind in zip(words, [*words[1:], entering], strict=True)
        ],
    )
