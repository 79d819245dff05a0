"""Ramp: gives the positions at which the profile is drawn."""

from myhdl import Signal, always, always_comb, always_seq, block, intbv

from golden.visualisation.load_profile import Ramp
from hdl.common.delay import delay
from hdl.common.signals import Stream, signed


@block
def ramp(clk, rst, out: Stream, *, in_valid, spec: Ramp):
    """One position for each ``in_valid``, from the first again after the last (Figure 5.25).

    Latency 1 clock, one position a clock. Reset leads back to the first position.
    """
    guard, step = spec.guard, spec.step
    low, high = spec.acc_low, spec.acc_high
    bound = 1 << (spec.acc_width - 1)
    acc = Signal(intbv(low, min=-bound, max=bound))
    following = signed(spec.acc_width)

    @always_comb
    def add():
        if acc == high:
            following.next = low
        else:
            following.next = acc + step

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_valid:
            acc.next = following

    @always(clk.posedge)
    def keep():
        if in_valid:
            out.data.next = acc >> guard
            out.last.next = acc == high

    mark = delay(clk, rst, in_valid, out.valid, clocks=1)
    return add, count, keep, mark
