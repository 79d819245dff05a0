"""plane_select: finds the bit of an operand for a pass, and what it does to the sum."""

from myhdl import always, always_comb, block

from golden.engine.formats import WIDTH
from golden.engine.plane_select import PlaneSelect
from golden.engine.replay import SIGN
from hdl.common.signals import flag, unsigned


@block
def plane_select(clk, *, word, plane, kind, take_weight, look_up, subtract, spec: PlaneSelect):
    """Whether a coefficient is added, subtracted or neither.

    Parameters
    ----------
    word : signed 18 bits
    plane : unsigned 19 bits
        One bit is set, that of the plane; the highest bit clears the sum.
    kind : unsigned 2 bits
        The operand: 0 the word, 1 the number one with the word's sign, 2 the word's distance from
        the middle of its segment, 3 the number one.
    take_weight, look_up : bool
        The program's weight counts, or the table's word does. All outputs come one clock after the
        word.
    subtract : bool
        The coefficient is subtracted.
    spec : PlaneSelect
    """
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
