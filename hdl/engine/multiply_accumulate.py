"""multiply_accumulate: one product a clock, added up."""

from myhdl import Signal, always, always_comb, block, modbv

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, WIDTH
from golden.engine.multiply_accumulate import PRODUCT_WIDTH, MultiplyAccumulate
from golden.engine.operand_memory import WORD
from hdl.common.delay import connect
from hdl.common.signals import fixed, signed, unsigned


@block
def multiply_accumulate(
    clk,
    operand,
    weight,
    take_intercept,
    table_word,
    first,
    first_of_output,
    acc,
    *,
    spec: MultiplyAccumulate,
):
    """acc = operand x coefficient + (acc, or half a unit of the result).

    Parameters
    ----------
    operand : signed 18 bits
    weight : unsigned 18 bits
        A signed code, 0 where the table has the coefficient.
    take_intercept : bool
        The high half of ``table_word`` is meant, not the low one.
    table_word : unsigned 36 bits
        0 where the program has the coefficient.
    first, first_of_output : bool
        Two clocks after an operand: a sum starts with its product.
    acc : signed ``spec.acc_width`` bits
        Three clocks after the operand.
    spec : MultiplyAccumulate

    Notes
    -----
    Registers before and behind the multiplier and behind the adder. No reset: a sum starts afresh.
    """
    span = 1 << (spec.acc_width - 1)
    half = 1 << (DROPPED - 1)
    half_output = half << OUTPUT_SHIFT
    bits = unsigned(WIDTH)
    chosen = unsigned(WIDTH)
    coeff, late = fixed(WORD), fixed(WORD)
    product = signed(PRODUCT_WIDTH)
    # The sums of a frame stay inside; what is added up between frames may wrap.
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
        late.next = operand

    @always(clk.posedge)
    def multiply():
        product.next = late * coeff

    @always_comb
    def start():
        if first_of_output:
            base.next = half_output
        elif first:
            base.next = half
        else:
            base.next = total

    @always(clk.posedge)
    def add():
        total.next = product + base

    return choose, join, keep, multiply, start, add, connect(total, acc)
