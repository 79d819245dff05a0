"""operand_select: makes the multiplier's operand from the word that was read."""

from myhdl import always, always_comb, block, concat, instances

from golden.engine.datapath import OperandSelect
from golden.engine.formats import DROPPED, WIDTH, WORD
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.signals import fixed, flag, signed, unsigned


@block
def operand_select(clk, word, kind, operand, *, spec: OperandSelect):
    """The word, the number one with its sign, its distance from a segment's middle, or one."""
    sign = WIDTH - 1
    middle = spec.segment_width - 1
    one = 1 << DROPPED
    minus_one = -one
    width = spec.segment_width
    bits = unsigned(width)
    below = flag()
    chosen, late = fixed(WORD), fixed(WORD)
    distance = signed(width)

    # Half a segment is subtracted: the highest bit of the offset in the segment, inverted, is the
    # sign of the distance.
    @always_comb
    def invert():
        below.next = not word[middle]

    @always_comb
    def measure():
        bits.next = concat(below, word[middle:])

    sign_distance = ops.signed_bits(bits, width, 0, distance)

    @always_comb
    def choose():
        if kind == 0:
            chosen.next = word
        elif kind == 2:
            chosen.next = distance
        elif kind == 1 and word[sign]:
            chosen.next = minus_one
        else:
            chosen.next = one

    @always(clk.posedge)
    def keep():
        late.next = chosen

    wait = delay(clk, None, late, operand, clocks=spec.latency - 1)
    return instances()
