"""Output collector: results that come side by side leave one after the other."""

from myhdl import always, always_comb, always_seq, block

from golden.networks.multiple import OutputCollector
from hdl.common.signals import Stream, Words, fixed, unsigned


@block
def shift_word(clk, load, loaded, following, word):
    """``word`` takes ``loaded`` in a clock with ``load``, otherwise the word that follows it."""

    @always(clk.posedge)
    def keep():
        if load:
            word.next = loaded
        else:
            word.next = following

    return keep


@block
def output_collector(clk, rst, in_: Stream, out: Stream, *, spec: OutputCollector):
    """``in_data_0``, ``in_data_1``, ... as a frame that starts one clock later (section 5.5).

    Latency 1 clock. The results of the next frame must not come before those of the last have left:
    ``spec.outputs`` clocks at the least. Reset clears the count of results still to leave.
    """
    outputs = spec.outputs
    words = Words(outputs, lambda: fixed(spec.fmt))
    remaining = unsigned(spec.count_width)

    # The last word is followed by itself.
    shifts = [
        shift_word(clk, in_.valid, in_.data[i], words[min(i + 1, outputs - 1)], words[i])
        for i in range(outputs)
    ]
    first = words[0]

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_.valid:
            remaining.next = outputs
        elif remaining != 0:
            remaining.next = remaining - 1

    @always_comb
    def show():
        out.valid.next = remaining != 0
        out.last.next = remaining == 1
        out.data.next = first

    return shifts, count, show
