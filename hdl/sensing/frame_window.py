"""Frame window: keeps past frames, and sends the samples of them that a network takes."""

import numpy as np
from myhdl import Signal, always, always_comb, always_seq, block, instances, intbv, modbv

from golden.sensing.frame_window import FrameWindow
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.rom import rom
from hdl.common.signals import Stream, flag, unsigned
from hdl.common.stream import past_whole


@block
def judge(clk, rst, in_: Stream, *, accept, good, broken, twin: FrameWindow):
    """Tells which samples belong to frames, and how frames end: as input_controller, undelayed."""
    final, spacing = twin.sensors - 1, twin.spacing
    count = unsigned(max(1, final.bit_length()))
    dropping, complete, early = flag(), flag(), flag()

    if spacing > 1:
        remaining = unsigned((spacing - 1).bit_length())

        compare = ops.unequal(remaining, 0, early)

        @always_seq(clk.posedge, reset=rst)
        def tick():
            if good:
                remaining.next = spacing - 1
            elif remaining != 0:
                remaining.next = remaining - 1

        @always_comb
        def check():
            good.next = accept and complete and in_.last and not early
    else:

        @always_comb
        def check():
            good.next = accept and complete and in_.last

    @always_comb
    def look():
        accept.next = in_.valid and not dropping
        complete.next = count == final

    @always_comb
    def refuse():
        broken.next = accept and (complete or in_.last) and not good

    @always_seq(clk.posedge, reset=rst)
    def step():
        if accept:
            if complete or in_.last:
                count.next = 0
                dropping.next = not in_.last
            else:
                count.next = count + 1
        elif in_.valid and in_.last:
            dropping.next = False

    return instances()


@block
def frame_window(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: FrameWindow):
    """After each good frame the samples of it and of past ones that a network takes.

    Latency from a frame's last sample to the first element: 3 clocks. The ring has one write and
    one read port and no reset. A wrong frame is written too, in the place of the one that follows.
    Reset clears flags, counters and the ring's addresses; nothing leaves until the past is whole.
    """
    words, final = spec.words, spec.elements - 1
    ring = [Signal(intbv(0, min=spec.fmt.low, max=spec.fmt.high + 1)) for _ in range(words)]
    # The places of the next sample and of the first sample of its frame; both wrap.
    place, start, read_addr = (Signal(modbv(0, min=0, max=words)) for _ in range(3))
    offset = unsigned(spec.addr_width)
    turn = unsigned(max(1, final.bit_length()))
    accept, good, broken, sending, closing = (flag() for _ in range(5))
    yields = flag() if spec.past else good
    count = judge(clk, rst, in_, accept=accept, good=good, broken=broken, twin=spec)
    past = [past_whole(clk, rst, good, yields, past=spec.past)] if spec.past else []

    @always(clk.posedge)
    def write():
        if accept:
            ring[place].next = in_.data

    @always_seq(clk.posedge, reset=rst)
    def advance():
        if broken:
            place.next = start
        elif accept:
            place.next = place + 1
        if good:
            start.next = place + 1
        frame_error.next = broken

    @always_seq(clk.posedge, reset=rst)
    def send():
        if yields:
            sending.next = True
            turn.next = 0
        elif closing:
            sending.next = False
        elif sending:
            turn.next = turn + 1

    @always_comb
    def close():
        closing.next = sending and turn == final

    look_up = rom(
        turn,
        offset,
        words=np.array(spec.offsets),
        meanings=[f"sensor {tap.sensor}, {tap.delay} before" for tap in spec.window.taps],
    )

    @always(clk.posedge)
    def find():
        read_addr.next = start - offset

    @always(clk.posedge)
    def read():
        out.data.next = ring[read_addr]

    mark = delay(clk, rst, sending, out.valid, clocks=2)
    mark_last = delay(clk, rst, closing, out.last, clocks=2)

    return instances()
