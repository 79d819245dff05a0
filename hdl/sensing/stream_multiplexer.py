"""Stream multiplexer: puts a network's result into its place among the samples."""

from myhdl import always, block

from golden.sensing.stream_multiplexer import StreamMultiplexer
from hdl.common.delay import delay
from hdl.common.signals import Stream, fixed, unsigned
from hdl.common.stream import position


@block
def stream_multiplexer(
    clk, rst, in_: Stream, out: Stream, *, result_valid, result, spec: StreamMultiplexer
):
    """The stream one clock later, element ``spec.slot`` of each frame replaced (section 5.5).

    Latency 1 clock, one element a clock. Reset clears the position and the flags.
    """
    slot = spec.slot
    held = fixed(spec.fmt)
    count = unsigned(spec.count_width)

    counter = position(clk, rst, in_, count, stop=slot + 1)

    @always(clk.posedge)
    def hold():
        if result_valid:
            held.next = result

    @always(clk.posedge)
    def splice():
        if count == slot:
            out.data.next = held
        else:
            out.data.next = in_.data

    mark = delay(clk, rst, in_.valid, out.valid, clocks=1)
    close = delay(clk, rst, in_.last, out.last, clocks=1)
    return counter, hold, splice, mark, close
