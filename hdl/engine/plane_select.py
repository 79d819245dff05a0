"""plane_select: finds the bit of an operand for a pass, and what it does to the sum."""

from myhdl import always, always_comb, block

from golden.engine.formats import WIDTH
from golden.engine.plane_select import PlaneSelect
from golden.engine.replay import SIGN
from hdl.common.signals import flag, unsigned


@block
def plane_select(clk, *, word, plane, kind, take_weight, look_up, subtract, spec: PlaneSelect):
    """Whether a coefficient is added, subtracted or neither."""
    width = spec.segment_width
    middle = width - 1
    bits = unsigned(WIDTH)
    upper, lower = unsigned(WIDTH - width), unsigned(width)
    high, low, negative, in_sign, in_middle = (flag() for _ in range(5))
    late = unsigned(2)

    @always_comb
    def copy():
        bits.next = word[WIDTH:]

    @always_comb
    def mask():
        upper.next = bits[WIDTH:width] & plane[WIDTH:width]
        lower.next = bits[width:] & plane[width:]

    # These registers stand behind a block RAM.
    @always(clk.posedge)
    def look():
        high.next = upper != 0
        low.next = lower != 0
        negative.next = bits[SIGN]
        in_sign.next = plane[SIGN]
        in_middle.next = plane[middle]
        late.next = kind

    # The highest bit of the offset in a segment, inverted, is the sign of the distance.
    @always_comb
    def choose():
        take_weight.next = late == 3 or (late == 0 and (high or low))
        look_up.next = late == 1 or (late == 2 and low != in_middle)
        subtract.next = in_sign or (late == 2 and in_middle) or (late == 1 and negative)

    return copy, mask, look, choose
