"""Holds back the first frames, because the past frames that a network needs are not there yet."""

from myhdl import always_seq, block

from hdl.common import ops
from hdl.common.signals import flag, unsigned


@block
def past_whole(clk, rst, good, yields, *, past: int):
    """``yields`` is ``good``, but stays low for the first ``past`` good frames after a reset.

    ``past`` is at least 1.
    """
    known = unsigned(past.bit_length())
    whole = flag()

    @always_seq(clk.posedge, reset=rst)
    def count():
        if good and not whole:
            known.next = known + 1

    return ops.equal(known, past, whole), ops.both(good, whole, yields), count
