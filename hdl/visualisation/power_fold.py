"""Power folding: raises a number to the power P with one multiplier."""

from myhdl import always, always_comb, always_seq, block, instances

from golden.numbers.fixed import Rounding
from golden.visualisation.power_fold import PowerFold
from hdl.common import ops
from hdl.common.delay import connect
from hdl.common.requantise import requantise
from hdl.common.signals import Stream, flag, signed, unsigned


@block
def power_fold(clk, rst, in_: Stream, out: Stream, *, spec: PowerFold):
    """``in_data`` to the power ``in_power`` (thesis section 5.8, Figure 5.25).

    One multiplier. Latency 2 (``spec.max_power`` - 1) + 1 clocks for every P: start 1, then product
    1 and rounding 1 for each use. Reset clears the valid flag and the count.
    """
    clocks = 2 * (spec.max_power - 1)
    held = unsigned(spec.in_width)
    acc, first, kept = (unsigned(spec.out_width) for _ in range(3))
    product = unsigned(spec.product_width)
    wide_data, wide_product = signed(spec.in_width + 1), signed(spec.product_width + 1)
    remaining = unsigned(clocks.bit_length())
    # How many more times the multiplier is used. Where P is below the largest power, the last uses
    # are left out.
    uses = unsigned(spec.power_width)
    rounded = flag()

    widen_data = connect(in_.data, wide_data)
    cut = requantise(wide_data, first, shift=spec.in_frac - spec.out_frac, rounding=Rounding.ROUND)
    widen_product = connect(product, wide_product)
    narrow = requantise(wide_product, kept, shift=spec.in_frac, rounding=Rounding.ROUND)

    @always_comb
    def alternate():
        rounded.next = remaining[0] and uses != 0

    @always(clk.posedge)
    def fold():
        product.next = acc * held
        if in_.valid:
            held.next = in_.data
            acc.next = first
            uses.next = in_.power - 1
        elif rounded:
            acc.next = kept
            uses.next = uses - 1

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_.valid:
            remaining.next = clocks
        elif remaining != 0:
            remaining.next = remaining - 1
        out.valid.next = remaining == 1 and not in_.valid

    show = ops.widen(acc, out.data)

    return instances()
