"""round_saturate: a sum becomes a word, or a sample does."""

from myhdl import always, always_comb, block, concat

from golden.engine.formats import DROPPED, SAMPLE_SHIFT, WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.round_saturate import RoundSaturate
from hdl.common.signals import fixed, flag, unsigned


@block
def round_saturate(clk, run, acc, sample, word, *, relu=None, spec: RoundSaturate):
    """The sum without its lowest bits, saturated; while no frame is computed, the sample.

    Parameters
    ----------
    run : bool
    acc : signed ``spec.acc_width`` bits
    sample : signed Fix(14,13)
    word : signed 18 bits
        It comes one clock later.
    relu : bool
        Only with ``spec.rectifies``: a sum below 0 becomes 0, and so do the lowest ``cut`` bits.
    spec : RoundSaturate
    """
    sign = spec.acc_width - 1
    # The bits from the highest one that is kept up to the sign are all alike where nothing
    # saturates.
    lowest = DROPPED + WIDTH - 1
    above = unsigned(sign - lowest + 1)
    ones = (1 << (sign - lowest + 1)) - 1
    high, low = WORD.high, WORD.low
    beyond = flag()
    kept, result, wide, moved = (fixed(WORD) for _ in range(4))
    top = sign + 1
    end = lowest + 1

    @always_comb
    def look():
        above.next = acc[top:lowest]

    @always_comb
    def compare():
        beyond.next = above != 0 and above != ones

    @always_comb
    def cut():
        kept.next = acc[end:DROPPED].signed()

    trim = ()
    if spec.cut:
        # A word of a ReLU ends where the bits end that are cut; its sign is no part of this.
        unit, bits = DROPPED + spec.cut, WIDTH - 1 - spec.cut
        above_unit, highest, shift = unit + 1, (1 << bits) - 1, spec.cut
        below, upper, last = unsigned(unit), unsigned(bits), flag()
        trimmed, placed = fixed(WORD), fixed(WORD)

        if spec.even:

            @always_comb
            def look_below():
                below.next = acc[unit:]

            @always_comb
            def choose_even():
                last.next = acc[unit] and below != 0

            rounding = look_below, choose_even
        else:

            @always_comb
            def take_last():
                last.next = acc[unit]

            rounding = take_last

        @always_comb
        def join():
            upper.next = concat(acc[lowest:above_unit], last)

        @always_comb
        def end_codes():
            if acc[sign]:
                trimmed.next = 0
            elif beyond:
                trimmed.next = highest
            else:
                trimmed.next = upper

        @always_comb
        def place():
            placed.next = trimmed << shift

        @always_comb
        def saturate():
            if relu:
                result.next = placed
            elif not beyond:
                result.next = kept
            elif acc[sign]:
                result.next = low
            else:
                result.next = high

        trim = rounding, join, end_codes, place
    elif spec.rectifies:

        @always_comb
        def saturate():
            if relu and acc[sign]:
                result.next = 0
            elif not beyond:
                result.next = kept
            elif acc[sign]:
                result.next = low
            else:
                result.next = high

    else:

        @always_comb
        def saturate():
            if not beyond:
                result.next = kept
            elif acc[sign]:
                result.next = low
            else:
                result.next = high

    @always_comb
    def widen():
        wide.next = sample

    @always_comb
    def move():
        moved.next = wide << SAMPLE_SHIFT

    @always(clk.posedge)
    def keep():
        if run:
            word.next = result
        else:
            word.next = moved

    return look, compare, cut, trim, saturate, widen, move, keep
