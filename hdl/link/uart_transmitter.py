"""uart_transmitter: turns bytes into bits on a line."""

from myhdl import Signal, always_comb, always_seq, block, concat, intbv

from golden.link.uart import BYTE_BITS, UartTransmitter
from hdl.common import ops
from hdl.common.signals import Stream, flag, unsigned


@block
def uart_transmitter(clk, rst, in_: Stream, *, tx, spec: UartTransmitter):
    """Bytes as start bit, eight bits from the lowest, stop bit; the line is 1 between them.

    A bit takes ``spec.divisor`` clocks. The start bit begins 1 clock after the byte is taken, and
    one byte follows another without a pause. Reset ends what is on its way.
    """
    top, bits = spec.divisor - 1, BYTE_BITS
    line = Signal(intbv((1 << bits) - 1, min=0, max=1 << bits))
    left = unsigned(bits.bit_length())
    tick = unsigned(top.bit_length())
    ends, ready, accept = flag(), flag(), flag()

    look = ops.equal(tick, top, ends)

    @always_comb
    def decide():
        ready.next = left == 0 or (left == 1 and ends)

    take = ops.both(in_.valid, ready, accept)

    @always_seq(clk.posedge, reset=rst)
    def divide():
        if accept or ends:
            tick.next = 0
        elif left != 0:
            tick.next = tick + 1

    @always_seq(clk.posedge, reset=rst)
    def step():
        if accept:
            left.next = bits
            line.next = concat(True, in_.data, False)
        elif ends:
            left.next = left - 1
            line.next = concat(True, line[bits:1])

    @always_comb
    def show():
        in_.ready.next = ready
        tx.next = line[0]

    return look, decide, take, divide, step, show
