"""Finds the good frames, and shows the words of each at once."""

from myhdl import block

from golden.layers.input_controller import InputController
from golden.precision import SIGNAL
from hdl.common.signals import fixed, flag, unsigned
from hdl.common.stream import catch, late_stream
from hdl.layers.input_controller import input_controller


@block
def judge(clk, rst, valid, last, good, frame_error, *, controller: InputController):
    """An input controller that only tells which frames are good; its other outputs stay open."""
    addr = unsigned(controller.addr_width)
    preset, accumulate, capture = flag(), flag(), flag()
    return input_controller(
        clk,
        rst,
        valid,
        last,
        addr,
        preset,
        accumulate,
        capture,
        good,
        frame_error,
        spec=controller,
    )


@block
def good_frame(
    clk, rst, valid, data, last, words, good, frame_error, *, controller: InputController
):
    """In the clock of ``good``, ``words`` are those of a whole frame; a wrong frame gives an error.

    The controller reports a good frame ``controller.latency`` clocks after its last element. The
    words are caught from the stream delayed by one clock less: so they are complete in time, and
    the next frame has replaced none of them.
    """
    late_valid, late_data, late_last = flag(), fixed(SIGNAL), flag()
    return (
        judge(clk, rst, valid, last, good, frame_error, controller=controller),
        late_stream(
            clk,
            rst,
            valid,
            data,
            last,
            late_valid,
            late_data,
            late_last,
            clocks=controller.latency - 1,
        ),
        catch(clk, rst, late_valid, late_data, late_last, words, first=0, slots=len(words)),
    )
