"""frame_guard: takes the samples of good frames, as frame_check, while a good image is there."""

from myhdl import Signal, always_comb, always_seq, block, modbv

from golden.engine.frame_check import FrameGuard
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.signals import Stream, flag


@block
def frame_guard(
    clk,
    rst,
    in_: Stream,
    *,
    halt,
    before_last,
    store,
    finish,
    start,
    run,
    busy,
    write,
    write_addr,
    frame_error,
    spec: FrameGuard,
):
    """Counts samples and results, and lets the program run after a good frame of a good image.

    One counter is the address of samples and results. It counts from -1, so that it is the address
    of the word that is written a clock later. Reset clears everything: the next sample starts a
    frame.
    """
    span = 1 << spec.addr_width
    none = span - 1
    # The address wraps from -1 to 0.
    addr = Signal(modbv(none, min=0, max=span))
    running, begins, started, dropping = (flag() for _ in range(4))
    closed, accept, complete, good, refused, broken = (flag() for _ in range(6))

    @always_comb
    def look():
        accept.next = in_.valid and not (closed or halt or dropping)
        refused.next = not dropping and (
            (in_.valid and closed) or (halt and (in_.valid or started))
        )
        complete.next = addr == before_last

    @always_comb
    def judge():
        good.next = accept and complete and in_.last
        broken.next = accept and (complete != in_.last)

    @always_seq(clk.posedge, reset=rst)
    def drop():
        frame_error.next = refused or broken
        if in_.valid:
            started.next = not in_.last
            dropping.next = not in_.last and (dropping or refused or broken)
        elif refused:
            dropping.next = True

    @always_seq(clk.posedge, reset=rst)
    def count():
        if finish or broken or halt:
            addr.next = none
        elif accept or store:
            addr.next = addr + 1

    @always_seq(clk.posedge, reset=rst)
    def mark():
        write.next = accept or store

    @always_seq(clk.posedge, reset=rst)
    def turn():
        if finish:
            running.next = False
        elif begins:
            running.next = True

    @always_comb
    def show():
        start.next = begins
        run.next = running
        busy.next = closed
        write_addr.next = addr

    common = look, judge, drop, count, mark, turn, show
    if spec.pipeline.run == 1:
        return common, connect(good, begins), connect(running, closed)

    waiting = flag()

    wait = ops.either(running, waiting, closed)

    @always_seq(clk.posedge, reset=rst)
    def stay():
        if good:
            waiting.next = True
        elif begins:
            waiting.next = False

    return common, wait, stay, delay(clk, rst, good, begins, clocks=spec.pipeline.run - 1)
