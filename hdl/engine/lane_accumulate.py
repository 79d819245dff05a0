"""lane_accumulate: selects the operand of a lane, multiplies it and adds the products up."""

from myhdl import Signal, always, always_comb, block, concat, instances, modbv

from golden.engine.datapath import LaneAccumulate
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, PRODUCT_WIDTH, WIDTH, WORD
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.signals import fixed, flag, signed, unsigned


@block
def lane_accumulate(
    clk, *, word, kind, coeff, opens, acc, high, low, gather=None, other=None, spec: LaneAccumulate
):
    """acc = operand x coefficient + (acc, or a start), or acc + the sum of another lane.

    A second register of the sum holds the start where a sum starts. So the LUTs of the adder have
    room for the choice of a product or another sum. No reset: a sum starts afresh.
    """
    span = 1 << (spec.acc_width - 1)
    sign = spec.acc_width - 1
    lowest = DROPPED + WIDTH - 1
    top, count = spec.acc_width, spec.acc_width - lowest
    ones = (1 << count) - 1
    above = unsigned(count)
    factor, factor_late, coeff_late = (fixed(WORD) for _ in range(3))
    product = signed(PRODUCT_WIDTH)
    opening = unsigned(2)
    # The sums of a frame stay within this range. What is added up between frames may wrap.
    total, base, start, added, grown = (Signal(modbv(0, min=-span, max=span)) for _ in range(5))
    half = 1 << (DROPPED - 1)
    other_opening, other_start, usual_start = (
        (3, half << OUTPUT_SHIFT, half) if spec.leads else (1, half, 0)
    )

    @always(clk.posedge)
    def keep():
        coeff_late.next = coeff[WIDTH:].signed()
        factor_late.next = factor

    @always(clk.posedge)
    def multiply():
        product.next = factor_late * coeff_late

    # A block RAM is too slow to drive the many registers that start a sum.
    @always(clk.posedge)
    def mark():
        opening.next = opens

    @always(clk.posedge)
    def store():
        total.next = grown

    @always(clk.posedge)
    def compare():
        high.next = above != 0 and not grown[sign]
        low.next = above != ones and grown[sign]

    @always_comb
    def prepare():
        if opening == other_opening:
            start.next = other_start
        else:
            start.next = usual_start

    @always(clk.posedge)
    def carry():
        if opening != 0:
            base.next = start
        else:
            base.next = grown

    return (
        select(clk, word, kind, factor, segment_width=spec.segment_width),
        keep,
        multiply,
        mark,
        prepare,
        gathered(clk, product, gather, other, added, width=spec.acc_width, partners=spec.partners),
        ops.add(base, added, grown),
        store,
        ops.bits(grown, top, lowest, above),
        compare,
        carry,
        connect(total, acc),
    )


@block
def select(clk, word, kind, factor, *, segment_width: int):
    """The operand, one clock later; without a table every odd kind is the number one."""
    one, sign = 1 << DROPPED, WIDTH - 1
    low, high = unsigned(DROPPED), unsigned(WIDTH - DROPPED)
    bits = unsigned(WIDTH)

    if not segment_width:

        @always(clk.posedge)
        def keep():
            if kind[0]:
                factor.next = one
            else:
                factor.next = word

        return keep

    middle = segment_width - 1
    below = flag()
    near, distance = unsigned(segment_width), signed(segment_width)
    wide, chosen = fixed(WORD), fixed(WORD)

    # Half a segment is subtracted: the highest bit of the offset in the segment, inverted, is the
    # sign of the distance.
    @always_comb
    def invert():
        below.next = not word[middle]

    @always_comb
    def measure():
        near.next = concat(below, word[middle:])

    sign_distance = ops.signed_bits(near, segment_width, 0, distance)
    widen = ops.widen(distance, wide)

    @always_comb
    def choose():
        if kind[1]:
            chosen.next = wide
        else:
            chosen.next = word

    # The low bits of the number one are 0, whatever its sign is.
    @always(clk.posedge)
    def keep_low():
        if kind[0]:
            low.next = 0
        else:
            low.next = chosen[DROPPED:]

    @always(clk.posedge)
    def keep_high():
        if kind == 3:
            high.next = 1
        elif kind == 1:
            high.next = concat(word[sign], word[sign], word[sign], True)
        else:
            high.next = chosen[WIDTH:DROPPED]

    join = ops.join(high, low, bits)
    show = ops.signed_bits(bits, WIDTH, 0, factor)

    return instances()


@block
def gathered(clk, product, gather, other, added, *, width: int, partners: int):
    """What is added: the product, or the sum of another lane, which a bit of ``gather`` names."""
    if not partners:
        return ops.widen(product, added)

    takes = flag()
    found = [signed(width) for _ in range(partners)]
    last = found[-1]

    @always(clk.posedge)
    def mark():
        takes.next = gather != 0

    @always_comb
    def choose():
        if takes:
            added.next = last
        else:
            added.next = product

    first = connect(other[0], found[0])
    if partners == 1:
        return mark, first, choose

    # The first one needs no bit: it is added where no other is named.
    late = unsigned(partners)
    levels = [either(late(n), other[n], found[n - 1], found[n]) for n in range(1, partners)]
    return mark, first, levels, choose, delay(clk, None, gather, late, clocks=1)


@block
def either(chosen, first, second, found):
    """``found`` is ``first`` where it is ``chosen``, else ``second``."""

    @always_comb
    def choose():
        if chosen:
            found.next = first
        else:
            found.next = second

    return choose
