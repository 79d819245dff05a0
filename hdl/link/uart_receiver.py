"""uart_receiver: turns the bits on a line into bytes."""

from myhdl import Signal, always, always_comb, always_seq, block, concat

from golden.link.uart import BYTE_BITS, UartReceiver
from hdl.common import ops
from hdl.common.signals import Stream, flag, unsigned


@block
def uart_receiver(clk, rst, out: Stream, *, rx, line_error, spec: UartReceiver):
    """The bytes of a line: start bit, eight bits from the lowest, stop bit.

    A bit takes ``spec.divisor`` clocks. A fall of the line begins a byte, if the line is 0 in the
    middle of the start bit; each further bit is read in its middle. Latency ``spec.latency`` clocks
    from the first clock of the start bit. Reset ends what is on its way.
    """
    top, final_place, high = spec.divisor - 1, BYTE_BITS - 1, 8
    # The first bit is read half a bit after its edge.
    skipped = spec.divisor - spec.divisor // 2
    raised, line, earlier = (Signal(bool(1)) for _ in range(3))
    running, starts, sample, ends = (flag() for _ in range(4))
    tick = unsigned(top.bit_length())
    place = unsigned(final_place.bit_length())
    kept = unsigned(high)

    @always_seq(clk.posedge, reset=rst)
    def synchronise():
        raised.next = rx
        line.next = raised
        earlier.next = line

    @always_comb
    def look():
        starts.next = earlier and not line and not running
        sample.next = running and tick == top

    @always_comb
    def decide():
        ends.next = sample and place == final_place

    @always_seq(clk.posedge, reset=rst)
    def divide():
        if starts:
            tick.next = skipped
        elif sample:
            tick.next = 0
        elif running:
            tick.next = tick + 1

    @always_seq(clk.posedge, reset=rst)
    def step():
        if starts:
            running.next = True
            place.next = 0
        elif ends or (sample and place == 0 and line):
            running.next = False
        elif sample:
            place.next = place + 1

    # The stop bit is not kept.
    @always(clk.posedge)
    def shift():
        if sample and not ends:
            kept.next = concat(line, kept[high:1])

    @always_seq(clk.posedge, reset=rst)
    def tell():
        out.valid.next = ends and line
        line_error.next = ends and not line

    return synchronise, look, decide, divide, step, shift, tell, ops.widen(kept, out.data)
