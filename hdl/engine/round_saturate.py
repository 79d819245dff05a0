"""round_saturate: a sum becomes a word, or a sample does."""

from myhdl import always, always_comb, block, concat

from golden.engine.formats import DROPPED, SAMPLE_SHIFT, WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.round_saturate import RoundSaturate
from hdl.common.delay import connect
from hdl.common.signals import fixed, flag, unsigned


@block
def round_saturate(clk, run, acc, sample, word, *, relu=None, spec: RoundSaturate):
    """The sum without its lowest bits, saturated; while no frame is computed, the sample."""
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

    @always_comb
    def saturate():
        if not beyond:
            result.next = kept
        elif acc[sign]:
            result.next = low
        else:
            result.next = high

    stored, rectify = result, ()
    if spec.rectifies:
        stored, positive = fixed(WORD), fixed(WORD)

        @always_comb
        def choose():
            if not relu:
                stored.next = result
            elif acc[sign]:
                stored.next = 0
            else:
                stored.next = positive

        rectify = trim(acc, beyond, result, positive, bits=spec.cut, even=spec.even), choose

    @always_comb
    def widen():
        wide.next = sample

    @always_comb
    def move():
        moved.next = wide << SAMPLE_SHIFT

    @always(clk.posedge)
    def keep():
        if run:
            word.next = stored
        else:
            word.next = moved

    return look, compare, cut, saturate, rectify, widen, move, keep


@block
def trim(acc, beyond, result, trimmed, *, bits: int, even: bool):
    """``trimmed`` is ``result``, of a sum that is not below 0, less ``bits`` low bits.

    Where ``even``, the lowest bit that is left becomes 0 in the middle between two words.
    """
    if not bits:
        return connect(result, trimmed)
    unit, shift = DROPPED + bits, bits
    above_shift, sign = shift + 1, WIDTH - 1
    below, last = unsigned(unit), flag()
    # A code of one bit has none above its lowest one.
    alone = above_shift == sign
    upper = unsigned(2 if alone else sign - shift)
    wide = fixed(WORD)

    if even:

        @always_comb
        def look_below():
            below.next = acc[unit:]

        # A sum beyond the word lies between no two words, whatever its lowest bits are.
        @always_comb
        def choose_last():
            last.next = result[shift] and (beyond or below != 0)

        rounding = look_below, choose_last
    else:
        rounding = connect(result(shift), last)

    if alone:

        @always_comb
        def join():
            upper.next = concat(False, last)

    else:

        @always_comb
        def join():
            upper.next = concat(result[sign:above_shift], last)

    @always_comb
    def widen():
        wide.next = upper

    @always_comb
    def place():
        trimmed.next = wide << shift

    return rounding, join, widen, place
