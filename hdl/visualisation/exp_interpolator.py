"""exp_interpolator: computes exp(-x) between two words of the memory."""

from myhdl import always, always_comb, block

from golden.visualisation.load_profile import ExpInterpolator
from hdl.common.delay import delay
from hdl.common.signals import Stream, unsigned


@block
def exp_interpolator(clk, rst, in_: Stream, out: Stream, *, spec: ExpInterpolator):
    """``in_word`` times 1 - delta, two clocks later.

    One multiplier. Latency 2 clocks, one result a clock. Reset clears the valid flags.
    """
    frac, word_width = spec.frac, spec.word_width
    factor_width = spec.factor_width
    ones = (1 << spec.offset_width) - 1
    # The factor is 1 + half - offset, where half is half the interval, and -offset is the same as
    # flipped - ones.
    base = (1 << frac) + (1 << (spec.offset_width - 1)) - ones
    flipped, factor = unsigned(factor_width), unsigned(factor_width)
    word = unsigned(word_width)
    product = unsigned(word_width + factor_width)

    @always_comb
    def flip():
        flipped.next = in_.offset ^ ones

    @always(clk.posedge)
    def multiply():
        factor.next = flipped + base
        word.next = in_.word
        product.next = word * factor

    # The words of exp_memory keep the product below 1.
    @always_comb
    def cut():
        out.data.next = product[word_width + frac : frac]

    mark = delay(clk, rst, in_.valid, out.valid, clocks=2)
    return flip, multiply, cut, mark
