"""image_receiver: takes an image out of packets, and passes its bytes on to an engine."""

from myhdl import always, always_comb, always_seq, block, concat, instances

from golden.link.image_receiver import ImageReceiver
from golden.link.packets import IMAGE, SYNC, kind_byte
from hdl.common import ops
from hdl.common.signals import Stream, flag, unsigned


@block
def queue_place(clk, *, put, take, behind, new, following, here, place: int):
    """One word of a queue.

    A new word comes in at the place behind the last one. All move up when the first one leaves.
    """

    @always(clk.posedge)
    def move():
        if put and behind == place:
            here.next = new
        elif take:
            here.next = following

    return move


@block
def queue(clk, rst, in_: Stream, out: Stream, *, depth: int):
    """Words leave in the order in which they came; each stays until it is taken, at least a clock.

    The words stand in registers, because not every device has a memory for so few of them.
    """
    stored, behind = unsigned(depth.bit_length()), unsigned(depth.bit_length())
    words = [unsigned(len(in_.data)) for _ in range(depth)]
    first = words[0]
    some, take = flag(), flag()

    look = ops.unequal(stored, 0, some)
    decide = ops.both(some, out.ready, take)

    @always_comb
    def find():
        if take:
            behind.next = stored - 1
        else:
            behind.next = stored

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_.valid:
            stored.next = behind + 1
        else:
            stored.next = behind

    @always_comb
    def show():
        out.valid.next = some
        out.data.next = first

    places = [
        queue_place(
            clk,
            put=in_.valid,
            take=take,
            behind=behind,
            new=in_.data,
            following=following,
            here=here,
            place=i,
        )
        for i, (here, following) in enumerate(zip(words, [*words[1:], 0], strict=True))
    ]

    return instances()


@block
def image_receiver(clk, rst, in_: Stream, load: Stream, *, spec: ImageReceiver):
    """Finds the packets of images among bytes, and hands the images on.

    Latency 1 clock, where nothing waits. A packet in which no byte comes for ``spec.idle_clocks``
    clocks ends: inside an image with a byte 0 and ``load_last``. Reset forgets what has come.
    """
    sync, kind, final = SYNC, kind_byte(IMAGE), spec.idle_clocks - 1
    place, length = unsigned(3), unsigned(16)
    idle = unsigned(max(1, final.bit_length()))
    over, filling, put, ends = (flag() for _ in range(4))
    named = unsigned(16)
    byte_in = unsigned(8)
    entering, leaving = unsigned(9), unsigned(9)

    @always_comb
    def look():
        over.next = idle == final and not in_.valid
        filling.next = place == 4
        named.next = concat(length[8:], in_.data)

    @always_comb
    def decide():
        put.next = filling and (in_.valid or over)
        ends.next = over or length == 1

    @always_seq(clk.posedge, reset=rst)
    def wait_for_byte():
        if in_.valid or over:
            idle.next = 0
        else:
            idle.next = idle + 1

    @always_seq(clk.posedge, reset=rst)
    def step():
        if over:
            place.next = 0
        elif in_.valid:
            if place == 0:
                if in_.data == sync:
                    place.next = 1
            elif place == 1:
                if in_.data == kind:
                    place.next = 2
                elif in_.data != sync:
                    place.next = 0
            elif place == 2:
                place.next = 3
            elif place == 3:
                if named == 0:
                    place.next = 0
                else:
                    place.next = 4
            elif length == 1:
                place.next = 0

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_.valid:
            if filling:
                length.next = length - 1
            else:
                length.next = named

    @always_comb
    def choose():
        if over:
            byte_in.next = 0
        else:
            byte_in.next = in_.data

    enter = ops.join(ends, byte_in, entering)
    hold = queue(
        clk,
        rst,
        Stream(valid=put, data=entering),
        Stream(valid=load.valid, data=leaving, ready=load.ready),
        depth=spec.depth,
    )

    @always_comb
    def show():
        load.data.next = leaving[8:]
        load.last.next = leaving[8]

    return instances()
