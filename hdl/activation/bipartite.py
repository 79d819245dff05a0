"""bipartite: computes tanh from two tables, without a multiplier."""

from myhdl import always, always_comb, block, concat

from golden.activation.bipartite import (
    BASE_WIDTH,
    FINE_WIDTH,
    FRAC,
    GROUP_WIDTH,
    MAGNITUDE_WIDTH,
    OFFSET_WIDTH,
    SEGMENT_WIDTH,
    WIDE_WIDTH,
    WIDER,
    Bipartite,
    texts,
)
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.rom import Constants
from hdl.common.signals import Stream, flag, signed, unsigned


def memories(activation: Bipartite) -> tuple[Constants, Constants]:
    """The tables of bases and of corrections; any number of nodes can read them."""
    bases, corrections = activation.bases, activation.corrections
    width = activation.table.correction_width
    codes = [word & (1 << width) - 1 for word in corrections]
    return (Constants(bases, BASE_WIDTH, texts(bases)), Constants(codes, width, texts(corrections)))


@block
def upper_bits(clk, in_data, upper, is_wide, *, activation: Bipartite):
    """One clock later: the bits of q with weights from 2 up to 8, saturated, and ``is_wide``.

    ``is_wide`` tells that the magnitude of q reaches 2. All of these stand in registers, so that
    each bit of an address is a function of four registers.
    """
    sign = activation.in_fmt.width - 1
    end = min(activation.reach_width, MAGNITUDE_WIDTH)
    width = end - FINE_WIDTH
    ones, high_ones = (1 << width) - 1, (1 << (sign - end)) - 1
    clipped = unsigned(width)
    reaches = flag()

    if activation.saturates:
        high = unsigned(sign - end)
        beyond = flag()

        look = ops.bits(in_data, sign, end, high)

        @always_comb
        def compare():
            if in_data[sign]:
                beyond.next = high != high_ones
            else:
                beyond.next = high != 0

        @always_comb
        def clip():
            if not beyond:
                clipped.next = in_data[end:FINE_WIDTH]
            elif in_data[sign]:
                clipped.next = 0
            else:
                clipped.next = ones

        saturation = look, compare, clip
    else:
        clip = ops.bits(in_data, end, FINE_WIDTH, clipped)

        saturation = clip

    @always_comb
    def reach():
        if in_data[sign]:
            reaches.next = clipped != ones
        else:
            reaches.next = clipped != 0

    return (
        saturation,
        reach,
        delay(clk, None, clipped, upper, clocks=1),
        delay(clk, None, reaches, is_wide, clocks=1),
    )


@block
def place(clk, in_data, negative, base_addr, slope_addr, *, activation: Bipartite):
    """The addresses of base and correction, and ``negative``, the sign; all come a clock later."""
    sign = activation.in_fmt.width - 1
    width = min(activation.reach_width, FINE_WIDTH)
    fine, wide, group = SEGMENT_WIDTH, WIDE_WIDTH, GROUP_WIDTH
    fine_end, wide_end = fine - OFFSET_WIDTH, wide - OFFSET_WIDTH + 1
    ones = (1 << width) - 1
    lower, mag = unsigned(width), unsigned(width)

    @always(clk.posedge)
    def keep():
        lower.next = in_data[width:]
        negative.next = in_data[sign]

    @always_comb
    def fold():
        if negative:
            mag.next = lower ^ ones
        else:
            mag.next = lower

    if not activation.wide:

        @always_comb
        def address():
            base_addr.next = mag[:fine]
            slope_addr.next = concat(mag[width:group], lower[fine:fine_end])

        return keep, fold, address

    upper = unsigned(min(activation.reach_width, MAGNITUDE_WIDTH) - FINE_WIDTH)
    most = (1 << len(upper)) - 1
    steps, switched = unsigned(WIDER), unsigned(WIDER)
    offset = unsigned(OFFSET_WIDTH)
    is_wide = flag()

    @always_comb
    def rise():
        if negative:
            steps.next = upper ^ most
        else:
            steps.next = upper

    @always_comb
    def switch():
        if is_wide:
            switched.next = steps
            offset.next = concat(lower[wide:wide_end], steps[1])
        else:
            switched.next = mag[wide:fine]
            offset.next = lower[fine:fine_end]

    @always_comb
    def address():
        base_addr.next = concat(is_wide, mag[width:wide], switched)
        slope_addr.next = concat(is_wide, mag[width:group], offset)

    clip = upper_bits(clk, in_data, upper, is_wide, activation=activation)
    return clip, keep, fold, rise, switch, address


@block
def turn(word, inverted, turned):
    """``turned`` is ``word``, or its complement where ``inverted`` is high."""
    ones = word.max - 1

    @always_comb
    def choose():
        if inverted:
            turned.next = word ^ ones
        else:
            turned.next = word

    return choose


@block
def read(clk, addr, word, *, memory: Constants):
    """A word of ``memory``, two clocks later.

    A block RAM is faster where its word goes straight into a register and not into an adder, and
    some block RAMs have that register inside.
    """
    found = unsigned(len(word))

    @always(clk.posedge)
    def fetch():
        found.next = memory[addr]

    return fetch, delay(clk, None, found, word, clocks=1)


@block
def from_memories(
    clk, *, base_addr, slope_addr, negative, base, slope, negative_late, bases, corrections
):
    """The two addends, two clocks later: the correction, and the base, inverted for q below 0."""
    base_word, slope_word = unsigned(len(base)), unsigned(len(corrections[0]))

    @always_comb
    def extend():
        slope.next = slope_word.signed()

    return (
        read(clk, base_addr, base_word, memory=bases),
        read(clk, slope_addr, slope_word, memory=corrections),
        delay(clk, None, negative, negative_late, clocks=2),
        turn(base_word, negative_late, base),
        extend,
    )


@block
def node(clk, in_data, out_data, memory, *, activation: Bipartite):
    """tanh for one node; it reads a ``memory`` that other nodes may read, too."""
    width = BASE_WIDTH
    base_addr = unsigned((len(activation.bases) - 1).bit_length())
    slope_addr = unsigned((len(activation.corrections) - 1).bit_length())
    negative, negative_late = flag(), flag()
    base, wide_base, slope = unsigned(width), signed(width + 1), signed(width + 1)
    total = signed(width + 2)
    result, joined = unsigned(width - FRAC), unsigned(activation.out_fmt.width)
    bases, corrections = memory

    find = from_memories(
        clk,
        base_addr=base_addr,
        slope_addr=slope_addr,
        negative=negative,
        base=base,
        slope=slope,
        negative_late=negative_late,
        bases=bases,
        corrections=corrections,
    )
    widen = ops.widen(base, wide_base)

    @always_comb
    def add():
        # The operand that stands first feeds the carries directly and not through a LUT. So it is
        # the correction, and the LUT at the other operand can invert the base.
        total.next = slope + wide_base

    drop = ops.bits(total, width, FRAC, result)
    join = ops.join(negative_late, result, joined)

    @always(clk.posedge)
    def keep():
        out_data.next = joined.signed()

    find_place = place(clk, in_data, negative, base_addr, slope_addr, activation=activation)
    return find_place, find, widen, add, drop, join, keep


@block
def bipartite(clk, rst, in_: Stream, out: Stream, *, spec: Bipartite):
    """tanh of ``in_data`` four clocks later.

    No multiplier. Latency 4: q 1, memories 1 and registers behind them 1, sum 1. One result a
    clock. Reset clears the valid flags.
    """
    return (
        node(clk, in_.data, out.data, memories(spec), activation=spec),
        delay(clk, rst, in_.valid, out.valid, clocks=spec.latency),
    )
