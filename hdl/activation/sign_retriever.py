"""Sign retriever: gives a magnitude its sign back."""

from myhdl import always, always_seq, block

from golden.activation.sign_retriever import SignRetriever
from hdl.common import ops
from hdl.common.signals import Stream, fixed


@block
def sign_retriever(clk, rst, in_: Stream, out: Stream, *, spec: SignRetriever):
    """``in_mag``, negated when ``in_negative``, one clock later (thesis section 4.5.2.4).

    Latency 1 clock, one code a clock. Reset clears ``out_valid`` alone.
    """
    positive = fixed(spec.fmt)
    opposite = fixed(spec.fmt)

    @always(clk.posedge)
    def keep():
        if in_.negative:
            out.data.next = opposite
        else:
            out.data.next = positive

    @always_seq(clk.posedge, reset=rst)
    def mark():
        out.valid.next = in_.valid

    return ops.widen(in_.mag, positive), ops.negate(positive, opposite), keep, mark
