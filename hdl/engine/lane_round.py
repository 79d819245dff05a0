"""lane_round: the sum of a lane, or what the first lane stores, becomes a word."""

from myhdl import always, always_comb, block, concat

from golden.engine.formats import DROPPED, SAMPLE_SHIFT, WIDTH
from golden.engine.lane_round import LaneRound
from golden.engine.operand_memory import WORD
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
    other=None,
    other_low=None,
    spec: LaneRound,
):
    """The sum without its lowest bits, saturated; without ``own`` what is given from outside.

    Parameters
    ----------
    own : bool
    acc, high, low : signed ``spec.acc_width`` bits, bool, bool
        A sum, and whether it is above or below every word.
    relu : bool
        Only with ``spec.rectifies``: a sum below 0 becomes 0.
    sample, next_word, next_low : signed Fix(14,13), signed 18 bits, bool
        Only in the first lane: what is given, and what the other lanes are given.
    other, other_low : signed 18 bits, bool
        Only in another lane: what is given, and whether its lowest 17 bits become 0.
    word : signed 18 bits
        It comes one clock later.
    spec : LaneRound

    Notes
    -----
    What becomes 0 is cleared by the reset of the register, so that each bit takes one LUT.
    """
    sign, sum_sign, end = WIDTH - 1, spec.acc_width - 1, DROPPED + WIDTH - 1
    ones = (1 << sign) - 1
    given, following, bits = fixed(WORD), fixed(WORD), unsigned(WIDTH)
    kept, taken, below = unsigned(sign), unsigned(sign), unsigned(sign)
    clears, low_now, top, taken_top, top_late = (flag() for _ in range(5))

    @always_comb
    def cut():
        if high:
            kept.next = ones
        else:
            kept.next = acc[end:DROPPED]

    if spec.rectifies:

        @always_comb
        def judge():
            clears.next = low or (relu and acc[sum_sign])
            top.next = acc[sum_sign] and not relu

    else:

        @always_comb
        def judge():
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

    @always(clk.posedge)
    def keep():
        if low_now:
            below.next = 0
        else:
            below.next = taken

    @always(clk.posedge)
    def keep_top():
        top_late.next = taken_top

    @always_comb
    def join():
        bits.next = concat(top_late, below)

    @always_comb
    def show():
        word.next = bits[WIDTH:].signed()

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

    @always_comb
    def widen():
        wide.next = sample

    @always_comb
    def move():
        given.next = wide << SAMPLE_SHIFT

    @always_comb
    def decide():
        low_now.next = own and clears

    @always_comb
    def pass_on():
        passed.next = concat(taken_top, taken)

    @always_comb
    def pass_word():
        following.next = passed[WIDTH:].signed()

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
