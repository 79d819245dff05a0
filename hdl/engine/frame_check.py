"""frame_check: accepts samples of good frames, rejects others, and signals when the engine runs."""

from myhdl import Signal, always_comb, always_seq, block, instances, modbv

from golden.engine.frame_check import FrameCheck
from hdl.common.delay import delay
from hdl.common.signals import Stream, flag


@block
def frame_check(
    clk,
    rst,
    in_: Stream,
    *,
    store=None,
    finish,
    start,
    run,
    write,
    write_addr,
    frame_error,
    spec: FrameCheck,
):
    """Counts samples and results, and lets the program run after a good frame.

    One counter is the address of samples and results. It counts from -1, so that it is the address
    of the word that is written a clock later. Reset clears everything: the next sample starts a
    frame.
    """
    span = 1 << spec.addr_width
    none, results = span - 1, spec.results
    before_last = (spec.inputs - 2) % span
    # The address wraps from -1 to 0.
    addr = Signal(modbv(none, min=0, max=span))
    running, dropping = flag(), flag()
    busy, accept, complete, good, early, broken = (flag() for _ in range(6))

    @always_comb
    def look():
        accept.next = in_.valid and not busy and not dropping
        early.next = in_.valid and busy and not dropping
        complete.next = addr == before_last

    @always_comb
    def judge():
        good.next = accept and complete and in_.last
        broken.next = accept and (complete != in_.last)

    @always_seq(clk.posedge, reset=rst)
    def drop():
        frame_error.next = early or broken
        if in_.valid:
            dropping.next = not in_.last and (dropping or early or broken)

    @always_seq(clk.posedge, reset=rst)
    def count():
        if finish or broken:
            addr.next = none
        elif (accept or store) if results else accept:
            addr.next = addr + 1

    @always_seq(clk.posedge, reset=rst)
    def mark():
        write.next = (accept or store) if results else accept

    @always_comb
    def show():
        run.next = running
        write_addr.next = addr

    if spec.pipeline.run == 1:

        @always_seq(clk.posedge, reset=rst)
        def turn():
            if finish:
                running.next = False
            elif good:
                running.next = True

        @always_comb
        def refuse():
            busy.next = running
            start.next = good

        return instances()

    opens, waiting = flag(), flag()

    @always_seq(clk.posedge, reset=rst)
    def turn():
        if finish:
            running.next = False
        elif opens:
            running.next = True
        if good:
            waiting.next = True
        elif opens:
            waiting.next = False

    @always_comb
    def refuse():
        busy.next = running or waiting
        start.next = opens

    late = delay(clk, rst, good, opens, clocks=spec.pipeline.run - 1)
    return instances()
