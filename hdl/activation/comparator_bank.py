"""Comparator bank: finds the segment of the activation in which a magnitude lies."""

from myhdl import always, always_comb, always_seq, block, intbv

from golden.activation.comparator_bank import ComparatorBank
from hdl.common.signals import Stream, flag, unsigned


@block
def comparator(mag, over, *, threshold: int):
    """``over`` tells that ``mag`` exceeds ``threshold``."""

    @always_comb
    def compare():
        over.next = mag > threshold

    return compare


@block
def comparator_bank(clk, rst, in_: Stream, out: Stream, *, spec: ComparatorBank):
    """Segment address of ``in_mag`` one clock later, with the magnitude beside it.

    Thesis section 4.5.2.3.1 C and the Addresser of 5.4.5.2: every comparator looks at the
    magnitude at once; the address is the number of thresholds exceeded.

    Latency 1 clock, one magnitude a clock. Reset clears ``out_valid`` alone.
    """
    count = len(spec.thresholds)
    over = [flag() for _ in range(count)]
    bank = [comparator(in_.mag, over[n], threshold=t) for n, t in enumerate(spec.thresholds)]
    addr = unsigned(spec.addr_width)

    @always(clk.posedge)
    def keep():
        out.mag.next = in_.mag

    @always_seq(clk.posedge, reset=rst)
    def mark():
        out.valid.next = in_.valid

    if count == 0:

        @always(clk.posedge)
        def stay():
            out.addr.next = 0

        return keep, mark, stay

    @always_comb
    def locate():
        # The thresholds rise, so the place of the last one that is exceeded is also their number.
        found = intbv(0, min=0, max=count + 1)
        found[:] = 0
        for n in range(count):
            if over[n]:
                found[:] = n + 1
        addr.next = found

    @always(clk.posedge)
    def keep_addr():
        out.addr.next = addr

    return bank, locate, keep, keep_addr, mark
