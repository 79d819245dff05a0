"""ABS: splits a signed code into sign and magnitude."""

from myhdl import always, always_comb, always_seq, block

from golden.activation.abs_unit import AbsUnit
from hdl.common import ops
from hdl.common.signals import Stream, signed, unsigned


@block
def abs_unit(clk, rst, in_: Stream, out: Stream, *, spec: AbsUnit):
    """Magnitude and sign of ``in_data`` one clock later (thesis section 4.5.2.2).

    Latency 1 clock, one code a clock. Reset clears ``out_valid`` alone.
    """
    width = spec.fmt.width
    high = spec.fmt.high
    # These are one bit wider than the input, because VHDL would negate -2**(width - 1) in the
    # input's own width.
    wide = signed(width + 1)
    opposite = signed(width + 1)
    magnitude = unsigned(spec.mag_width)

    @always_comb
    def choose():
        if not in_.data[width - 1]:
            magnitude.next = wide[width - 1 :]
        elif opposite[width - 1]:
            # This is the most negative code alone; to compare would take another row of carries.
            magnitude.next = high
        else:
            magnitude.next = opposite[width - 1 :]

    @always(clk.posedge)
    def keep():
        out.mag.next = magnitude
        out.negative.next = in_.data[width - 1]

    @always_seq(clk.posedge, reset=rst)
    def mark():
        out.valid.next = in_.valid

    return ops.widen(in_.data, wide), ops.negate(wide, opposite), choose, keep, mark
