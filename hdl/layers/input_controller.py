"""CONTROLLER 1: counts the samples of a frame and refuses frames of the wrong length."""

from myhdl import always_comb, always_seq, block, instances

from golden.layers.input_controller import InputController
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.signals import Stream, fixed, flag, unsigned
from hdl.common.stream import catch, late_stream


@block
def input_controller(
    clk,
    rst,
    in_: Stream,
    *,
    addr,
    preset,
    accumulate,
    capture,
    out_valid,
    frame_error,
    spec: InputController,
):
    """Address and controls for the nodes of the input integral (thesis 5.4.5.1, CONTROLLER 1).

    Throughput one sample a clock. Reset clears everything: the next sample starts a frame.
    """
    inputs = spec.inputs
    spacing = spec.spacing
    count = unsigned(spec.addr_width)
    dropping = flag()
    accept, complete, done, broken = flag(), flag(), flag(), flag()
    early, opening, accepted = flag(), flag(), flag()

    if spacing > 1:
        remaining = unsigned((spacing - 1).bit_length())

        compare = ops.unequal(remaining, 0, early)

        @always_seq(clk.posedge, reset=rst)
        def tick():
            if done:
                remaining.next = spacing - 1
            elif remaining != 0:
                remaining.next = remaining - 1

        @always_comb
        def check():
            done.next = accept and complete and in_.last and not early
    else:

        @always_comb
        def check():
            done.next = accept and complete and in_.last

    @always_comb
    def look():
        accept.next = in_.valid and not dropping
        complete.next = count == inputs - 1

    @always_comb
    def judge():
        broken.next = accept and (complete or in_.last) and not done

    show = ops.widen(count, addr)

    @always_seq(clk.posedge, reset=rst)
    def step():
        opening.next = accept and count == 0
        accepted.next = accept
        frame_error.next = broken
        if accept:
            if complete or in_.last:
                count.next = 0
                dropping.next = not in_.last
            else:
                count.next = count + 1
        elif in_.valid and in_.last:
            dropping.next = False

    open_frame = delay(clk, rst, opening, preset, clocks=1)
    gather = delay(clk, rst, accepted, accumulate, clocks=1)
    finish = delay(clk, rst, done, capture, clocks=3)
    mark = delay(clk, rst, done, out_valid, clocks=4)
    return instances()


@block
def judge(clk, rst, in_: Stream, *, good, frame_error, controller: InputController):
    """An input controller that only tells which frames are good; its other outputs stay open."""
    addr = unsigned(controller.addr_width)
    preset, accumulate, capture = flag(), flag(), flag()
    return input_controller(
        clk,
        rst,
        in_,
        addr=addr,
        preset=preset,
        accumulate=accumulate,
        capture=capture,
        out_valid=good,
        frame_error=frame_error,
        spec=controller,
    )


@block
def good_frame(clk, rst, in_: Stream, words, *, good, frame_error, controller: InputController):
    """In the clock of ``good``, ``words`` are those of a whole frame; a wrong frame gives an error.

    The controller reports a good frame ``controller.latency`` clocks after its last element. The
    words are caught from the stream delayed by one clock less: so they are complete in time, and
    the next frame has replaced none of them.
    """
    late_valid, late_data, late_last = flag(), fixed(SIGNAL), flag()
    late = Stream(valid=late_valid, data=late_data, last=late_last)
    return (
        judge(clk, rst, in_, good=good, frame_error=frame_error, controller=controller),
        late_stream(clk, rst, in_, late, clocks=controller.latency - 1),
        catch(clk, rst, late, words, first=0, slots=len(words)),
    )
