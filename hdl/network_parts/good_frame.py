"""Finds the good frames, and shows the words of each at once."""

from myhdl import block

from golden.layers.input_controller import InputController
from golden.numbers.precision import SIGNAL
from hdl.common.signals import Stream, fixed, flag, unsigned
from hdl.common.stream import catch, late_stream
from hdl.layers.input_controller import input_controller


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
