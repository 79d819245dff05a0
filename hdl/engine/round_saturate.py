"""round_saturate: a sum becomes a word, or a sample does."""

from myhdl import always, always_comb, block

from golden.engine.datapath import RoundSaturate
from golden.engine.formats import DROPPED, SAMPLE_SHIFT, WIDTH, WORD
from hdl.common import ops
from hdl.common.signals import fixed, flag, unsigned


@block
def round_saturate(clk, run, acc, sample, word, *, spec: RoundSaturate):
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

    look = ops.bits(acc, top, lowest, above)

    @always_comb
    def compare():
        beyond.next = above != 0 and above != ones

    cut = ops.signed_bits(acc, end, DROPPED, kept)

    @always_comb
    def saturate():
        if not beyond:
            result.next = kept
        elif acc[sign]:
            result.next = low
        else:
            result.next = high

    widen = ops.widen(sample, wide)
    move = ops.shift_left(wide, SAMPLE_SHIFT, moved)

    @always(clk.posedge)
    def keep():
        if run:
            word.next = result
        else:
            word.next = moved

    return look, compare, cut, saturate, widen, move, keep
