"""Argmax: the largest output of each frame, and how far the next one is behind it."""

from myhdl import always, always_comb, always_seq, block, instances

from golden.layers.argmax import Argmax
from hdl.common import ops
from hdl.common.delay import connect
from hdl.common.signals import Stream, fixed, flag, signed, unsigned
from hdl.common.stream import position


@block
def argmax(clk, rst, in_: Stream, out: Stream, *, spec: Argmax):
    """Index and margin of the largest of the outputs that come one after the other.

    Latency 1 clock; frames may follow each other without a gap. Reset clears ``out_valid`` and the
    place in the frame, so that the next output is the first of a frame.
    """
    width, widest = spec.fmt.width, (1 << spec.fmt.width) - 1
    count = unsigned(spec.index_fmt.width)
    largest = fixed(spec.fmt)
    margin = unsigned(width)
    behind = signed(width + 1)
    low, folded = unsigned(width), unsigned(width)
    # The carry is never set in a steady state, but it may be while the sign and the bits change.
    distance = unsigned(width + 1)
    first, leads, closer = flag(), flag(), flag()

    # How far the new output is behind the largest one before.
    subtract = ops.subtract(largest, in_.data, behind)

    @always_comb
    def split():
        leads.next = behind[width]
        low.next = behind[width:]

    # Without the sign the distance has the bits of the difference, or those of its complement and
    # one. So both cases need one addition.
    @always_comb
    def fold():
        if leads:
            folded.next = ~low
        else:
            folded.next = low

    measure = ops.add(folded, leads, distance)

    @always_comb
    def look():
        first.next = count == 0
        closer.next = low < margin

    @always(clk.posedge)
    def lead():
        if in_.valid and (first or leads):
            largest.next = in_.data
            out.index.next = count

    # There is no second output yet when the first one comes.
    @always(clk.posedge)
    def compare():
        if in_.valid:
            if first:
                margin.next = widest
            elif leads or closer:
                margin.next = distance[width:]

    @always_seq(clk.posedge, reset=rst)
    def finish():
        out.valid.next = in_.valid and in_.last

    number = position(clk, rst, in_, count, stop=spec.outputs - 1)
    show = connect(margin, out.margin)

    return instances()
