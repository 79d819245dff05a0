"""Frames that yield nothing because the past is not whole."""

from myhdl import always_comb, always_seq, block

from hdl.common.signals import flag, unsigned


@block
def past_whole(clk, rst, good, yields, *, past: int):
    """``yields`` is ``good`` of every frame behind the first ``past``, 1 or more, after a reset."""
    known = unsigned(past.bit_length())
    whole = flag()

    @always_comb
    def compare():
        whole.next = known == past

    @always_comb
    def decide():
        yields.next = good and whole

    @always_seq(clk.posedge, reset=rst)
    def count():
        if good and not whole:
            known.next = known + 1

    return compare, decide, count
