"""serial_accumulate: doubles a sum from plane to plane, and adds coefficients."""

from myhdl import Signal, always, always_comb, block, concat, modbv

from golden.engine.formats import WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.replay import CLEAR, HALF_OUTPUT_PLANE, HALF_PLANE
from golden.engine.serial_accumulate import SerialAccumulate
from hdl.common.signals import fixed, flag, signed, unsigned


@block
def serial_accumulate(
    clk,
    *,
    weight,
    take_weight,
    subtract,
    plane,
    first,
    of_output,
    table_word,
    acc,
    spec: SerialAccumulate,
):
    """acc = (acc, or 2 acc and half a unit of the result in its plane) +- coefficient; or 0.

    Subtracting is adding the complement and a carry into a bit below the lowest. Half a unit is
    what enters at the lowest bit when the sum is doubled. No reset: a pass clears the sum.
    """
    width = spec.acc_width
    kept, bits, turned = unsigned(WIDTH), unsigned(WIDTH), unsigned(WIDTH)
    coeff = fixed(WORD)
    wide = signed(width)
    minus, doubles, half, clears = flag(), flag(), flag(), flag()
    minus_late, doubles_late, half_late, clears_late = flag(), flag(), flag(), flag()
    # The sums of a program stay within this range. What is added up between frames may wrap.
    span = 1 << width
    total, base = unsigned(width), unsigned(width)
    left, right = unsigned(width + 1), unsigned(width + 1)
    grown = Signal(modbv(0, min=0, max=2 * span))
    top, highest = width + 1, width - 1

    @always(clk.posedge)
    def keep():
        if take_weight:
            kept.next = weight
        else:
            kept.next = 0

    @always(clk.posedge)
    def follow():
        minus.next = subtract
        doubles.next = first
        clears.next = plane[CLEAR]
        if of_output:
            half.next = plane[HALF_OUTPUT_PLANE]
        else:
            half.next = plane[HALF_PLANE]

    @always_comb
    def join():
        bits.next = kept | table_word

    @always_comb
    def turn():
        if minus:
            turned.next = ~bits
        else:
            turned.next = bits

    # These registers stand between a block RAM and an adder.
    @always(clk.posedge)
    def sign():
        coeff.next = turned[WIDTH:].signed()
        minus_late.next = minus
        doubles_late.next = doubles
        half_late.next = half
        clears_late.next = clears

    @always_comb
    def widen():
        wide.next = coeff

    @always_comb
    def double():
        if doubles_late:
            base.next = concat(total[highest:], half_late)
        else:
            base.next = total

    @always_comb
    def carry():
        left.next = concat(wide[width:], minus_late)
        right.next = concat(base, minus_late)

    @always_comb
    def add():
        grown.next = left + right

    @always(clk.posedge)
    def store():
        if clears_late:
            total.next = 0
        else:
            total.next = grown[top:1]

    @always_comb
    def show():
        acc.next = total.signed()

    return keep, follow, join, turn, sign, widen, double, carry, add, store, show
