"""frame_guard: takes the samples of good frames, as frame_check, while a good image is there."""

from myhdl import Signal, always_comb, always_seq, block, modbv

from golden.engine.frame_guard import FrameGuard
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

    Parameters
    ----------
    in_valid, in_last : bool
        The sample stream without its data.
    halt : bool
        No frame is taken, and a frame of which samples were taken already is broken. It is never
        high while ``busy`` is.
    before_last : unsigned ``spec.addr_width`` bits
        The number of samples in a frame, less 2.
    store : bool
        A result is ready. This may only come while ``run`` is high, and in the clock after.
    finish : bool
        The last output of the frame leaves.
    start : bool
        It is high in the clock before ``run`` rises.
    run, busy : bool
        A frame is being computed. ``run`` is high from ``spec.pipeline.run`` clocks after the
        frame's last sample up to ``finish``, and ``busy`` from the clock after that sample.
    write, write_addr : bool, unsigned ``spec.addr_width`` bits
        They come one clock after a sample that is taken, or after a result.
    frame_error : bool
        It is high for one clock, one clock after what breaks a frame: its ``last`` is too early or
        missing, its first sample comes while another frame is computed, or ``halt`` is high at any
        clock from its first sample to its last.
    spec : FrameGuard

    Notes
    -----
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

    @always_comb
    def wait():
        closed.next = running or waiting

    @always_seq(clk.posedge, reset=rst)
    def stay():
        if good:
            waiting.next = True
        elif begins:
            waiting.next = False

    return common, wait, stay, delay(clk, rst, good, begins, clocks=spec.pipeline.run - 1)
