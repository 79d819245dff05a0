"""bipartite: tanh from two tables, without a multiplier."""

from myhdl import always, always_comb, block, concat

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import FINE_WIDTH, MAGNITUDE_WIDTH, WIDER
from hdl.common.delay import delay
from hdl.common.rom import Constants
from hdl.common.signals import flag, signed, unsigned


def memories(activation: Bipartite) -> tuple[Constants, Constants]:
    """The words of bases and corrections, for however many nodes read them."""
    fmt, bases, corrections = activation.formats, activation.bases, activation.corrections
    width = activation.table.correction_width
    codes = [word & (1 << width) - 1 for word in corrections]
    return (
        Constants(bases, fmt.base_width, fmt.texts(bases)),
        Constants(codes, width, fmt.texts(corrections)),
    )


@block
def upper_bits(clk, in_data, upper, is_wide, *, activation: Bipartite):
    """The bits of q from 2 up to 8, saturated, and whether its magnitude reaches 2, a clock later.

    They stand in registers, so that each bit of an address is a function of four of these.
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

        @always_comb
        def look():
            high.next = in_data[sign:end]

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

        @always_comb
        def clip():
            clipped.next = in_data[end:FINE_WIDTH]

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
    """The addresses of base and correction; ``negative`` is the sign, a clock later."""
    fmt = activation.formats
    sign = activation.in_fmt.width - 1
    width = min(activation.reach_width, FINE_WIDTH)
    fine, wide, group = fmt.segment_width, fmt.wide_width, fmt.group_width
    fine_end, wide_end = fine - fmt.offset_width, wide - fmt.offset_width + 1
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
    offset = unsigned(fmt.offset_width)
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

    return (
        upper_bits(clk, in_data, upper, is_wide, activation=activation),
        keep,
        fold,
        rise,
        switch,
        address,
    )


@block
def read(clk, addr, word, *, memory: Constants):
    """A word of ``memory``, two clocks later.

    A block RAM whose word is a register's at once is faster than one behind which it is added, and
    some have that register inside.
    """
    found = unsigned(len(word))

    @always(clk.posedge)
    def fetch():
        found.next = memory[addr]

    return fetch, delay(clk, None, found, word, clocks=1)


@block
def node(clk, in_data, out_data, bases, corrections, *, activation: Bipartite):
    """tanh of one node, from memories that others may read as well."""
    fmt = activation.formats
    width, frac = fmt.base_width, fmt.frac
    ones = (1 << width) - 1
    out_sign = activation.out_fmt.width - 1
    base_addr = unsigned((len(bases) - 1).bit_length())
    slope_addr = unsigned((len(corrections) - 1).bit_length())
    negative, negative_late = flag(), flag()
    base, turned = unsigned(width), unsigned(width)
    slope = unsigned(activation.table.correction_width)
    wide_base, correction = signed(width + 1), signed(width + 1)
    total = signed(width + 2)
    result = unsigned(out_sign)

    @always_comb
    def turn():
        if negative_late:
            turned.next = base ^ ones
        else:
            turned.next = base

    @always_comb
    def widen():
        wide_base.next = turned
        correction.next = slope.signed()

    @always_comb
    def add():
        # The correction first: carries then come from it, as it is, and a LUT turns the base.
        total.next = correction + wide_base

    @always_comb
    def cut():
        result.next = total[width:frac]

    @always(clk.posedge)
    def keep():
        out_data.next = concat(negative_late, result)

    return (
        place(clk, in_data, negative, base_addr, slope_addr, activation=activation),
        read(clk, base_addr, base, memory=bases),
        read(clk, slope_addr, slope, memory=corrections),
        delay(clk, None, negative, negative_late, clocks=2),
        turn,
        widen,
        add,
        cut,
        keep,
    )


@block
def bipartite(clk, rst, in_valid, in_data, out_valid, out_data, *, spec: Bipartite):
    """tanh of ``in_data`` four clocks later.

    Parameters
    ----------
    in_valid, in_data : bool, signed ``spec.in_fmt``
    out_valid, out_data : bool, signed ``spec.out_fmt``
    spec : Bipartite
        Where the tables stand, and how much of them; the twin states rounding and error.

    Notes
    -----
    No multiplier. Latency: q 1, memories 1, registers behind them 1, sum 1. One result a clock.
    Reset clears the valid flags.
    """
    bases, corrections = memories(spec)
    return (
        node(clk, in_data, out_data, bases, corrections, activation=spec),
        delay(clk, rst, in_valid, out_valid, clocks=spec.latency),
    )
