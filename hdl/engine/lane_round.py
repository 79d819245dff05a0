"""lane_round: the sum of a lane, or what the first lane stores, becomes a word."""

from myhdl import always, always_comb, block, concat

from golden.engine.datapath import LaneRound
from golden.engine.formats import DROPPED, SAMPLE_SHIFT, WIDTH, WORD
from hdl.common import ops
from hdl.common.delay import connect
from hdl.common.signals import fixed, flag, unsigned


@block
def lane_round(
    clk,
    *,
    own,
    acc,
    high,
    low,
    word,
    relu=None,
    sample=None,
    next_word=None,
    next_low=None,
    next_cut=None,
    next_even=None,
    other=None,
    other_low=None,
    other_cut=None,
    other_even=None,
    spec: LaneRound,
):
    """The sum without its lowest bits, saturated; without ``own`` what is given from outside.

    What becomes 0 is cleared by the reset of the register, so that each bit takes one LUT.
    """
    sign, sum_sign, end = WIDTH - 1, spec.acc_width - 1, DROPPED + WIDTH - 1
    ones, rectifies = (1 << sign) - 1, spec.rectifies
    given, following, bits = fixed(WORD), fixed(WORD), unsigned(WIDTH)
    kept, taken, below = unsigned(sign), unsigned(sign), unsigned(sign)
    clears, low_now, top, taken_top, top_late = (flag() for _ in range(5))

    @always_comb
    def cut():
        if high:
            kept.next = ones
        else:
            kept.next = acc[end:DROPPED]

    @always_comb
    def judge():
        if rectifies:
            clears.next = low or (relu and acc[sum_sign])
            top.next = acc[sum_sign] and not relu
        else:
            clears.next = low
            top.next = acc[sum_sign]

    @always_comb
    def choose():
        if own:
            taken.next = kept
            taken_top.next = top
        else:
            taken.next = given[sign:]
            taken_top.next = given[sign]

    if spec.cut:
        cut_now, even_now = flag(), flag() if spec.even else None
        keep = (
            zero(own, relu, other_cut, cut_now),
            connect(cut_now, next_cut) if spec.leads else (),
            halve(acc, high=high, relu=relu, own=own, given=other_even, now=even_now, bits=spec.cut)
            if spec.even
            else (),
            connect(even_now, next_even) if spec.leads and spec.even else (),
            keep_codes(clk, taken, below, low=low_now, cut=cut_now, even=even_now, bits=spec.cut),
        )
    else:

        @always(clk.posedge)
        def keep():
            if low_now:
                below.next = 0
            else:
                below.next = taken

    @always(clk.posedge)
    def keep_top():
        top_late.next = taken_top

    join = ops.join(top_late, below, bits)
    show = ops.signed_bits(bits, WIDTH, 0, word)

    common = cut, judge, choose, keep, keep_top, join, show
    if not spec.leads:

        @always_comb
        def decide():
            if own:
                low_now.next = clears
            else:
                low_now.next = other_low

        return common, connect(other, given), decide

    wide, passed = fixed(WORD), unsigned(WIDTH)

    widen = ops.widen(sample, wide)
    move = ops.shift_left(wide, SAMPLE_SHIFT, given)
    decide = ops.both(own, clears, low_now)
    pass_on = ops.join(taken_top, taken, passed)
    pass_word = ops.signed_bits(passed, WIDTH, 0, following)

    return (
        common,
        widen,
        move,
        decide,
        pass_on,
        pass_word,
        connect(following, next_word),
        connect(low_now, next_low),
    )


@block
def zero(own, here, given, now):
    """``now`` is ``here`` where the sum is its ``own``, and else what is ``given``, or low."""
    alone = given is None

    @always_comb
    def decide():
        if alone:
            now.next = own and here
        elif own:
            now.next = here
        else:
            now.next = given

    return decide


@block
def halve(acc, *, high, relu, own, given, now, bits: int):
    """``now`` says that a code becomes the even one; see ``zero``.

    A sum beyond the word lies between no two words, whatever its lowest bits are.
    """
    unit = DROPPED + bits
    rest, halfway = unsigned(unit), flag()

    @always_comb
    def compare():
        halfway.next = rest == 0 and relu and not high

    return ops.bits(acc, unit, 0, rest), compare, zero(own, halfway, given, now)


@block
def keep_codes(clk, taken, below, *, low, cut, even, bits: int):
    """``below`` is ``taken``, one clock later, without what becomes 0.

    Bits that become 0 together have a reset of their own: with ``low`` all bits, with ``cut`` the
    lowest ``bits`` ones, which a code of a quantiser has not, and with ``even``, which may be None,
    the lowest bit of the code.
    """
    sign = WIDTH - 1
    above = bits + (even is not None)
    # A code of one bit has none above its lowest one.
    alone = above == sign
    fine, code, last = unsigned(bits), unsigned(1 if alone else sign - above), flag()

    @always(clk.posedge)
    def keep_fine():
        if low or cut:
            fine.next = 0
        else:
            fine.next = taken[bits:]

    if not alone:

        @always(clk.posedge)
        def keep_code():
            if low:
                code.next = 0
            else:
                code.next = taken[sign:above]

    if even is None:
        join = ops.join(code, fine, below)

        return keep_fine, keep_code, join

    @always(clk.posedge)
    def keep_last():
        if low or even:
            last.next = False
        else:
            last.next = taken[bits]

    if alone:
        join = ops.join(last, fine, below)

        return keep_fine, keep_last, join

    @always_comb
    def join():
        below.next = concat(code, last, fine)

    return keep_fine, keep_code, keep_last, join
