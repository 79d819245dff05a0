"""multiply_accumulate: adds up products, one per clock."""

from myhdl import Signal, always, always_comb, block, modbv

from golden.engine.datapath import MultiplyAccumulate
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, PRODUCT_WIDTH, WIDTH, WORD
from hdl.common.delay import connect
from hdl.common.signals import fixed, flag, signed, unsigned


@block
def multiply_accumulate(
    clk,
    *,
    operand,
    weight,
    take_intercept,
    table_word,
    first,
    first_of_output,
    acc,
    spec: MultiplyAccumulate,
):
    """acc = operand x coefficient + (acc, or half a unit of the result).

    Registers behind the memories, before and behind the multiplier, and behind the adder. No reset:
    a sum starts afresh.
    """
    span = 1 << (spec.acc_width - 1)
    half = 1 << (DROPPED - 1)
    half_output = half << OUTPUT_SHIFT
    opening, opening_output = flag(), flag()
    bits = unsigned(WIDTH)
    chosen = unsigned(WIDTH)
    coeff, coeff_late, factor, factor_late = (fixed(WORD) for _ in range(4))
    product = signed(PRODUCT_WIDTH)
    # The sums of a frame stay within this range. What is added up between frames may wrap.
    base, total = (Signal(modbv(0, min=-span, max=span)) for _ in range(2))

    @always_comb
    def choose():
        if take_intercept:
            chosen.next = table_word[PRODUCT_WIDTH:WIDTH]
        else:
            chosen.next = table_word[WIDTH:]

    @always_comb
    def join():
        bits.next = weight | chosen

    @always(clk.posedge)
    def keep():
        coeff.next = bits[WIDTH:].signed()
        factor.next = operand

    # A multiplier takes these registers into itself; the wires to it are long.
    @always(clk.posedge)
    def carry():
        coeff_late.next = coeff
        factor_late.next = factor

    @always(clk.posedge)
    def multiply():
        product.next = factor_late * coeff_late

    # These flags have registers of their own, because the path from a block RAM through the adder's
    # carries would be too long.
    @always(clk.posedge)
    def mark():
        opening.next = first
        opening_output.next = first_of_output

    @always_comb
    def start():
        if opening_output:
            base.next = half_output
        elif opening:
            base.next = half
        else:
            base.next = total

    @always(clk.posedge)
    def add():
        total.next = product + base

    return choose, join, keep, carry, multiply, mark, start, add, connect(total, acc)
