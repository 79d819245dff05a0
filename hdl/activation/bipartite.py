"""bipartite: tanh from two tables, without a multiplier."""

from myhdl import always, always_comb, block, concat

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import FINE_WIDTH, WIDER
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
def place(in_data, base_addr, slope_addr, *, activation: Bipartite):
    """The addresses of base and correction."""
    fmt, reach = activation.formats, activation.reach_width
    sign = activation.in_fmt.width - 1
    fine, wide, group = fmt.segment_width, fmt.wide_width, fmt.group_width
    fine_end, wide_end = fine - fmt.offset_width, wide - fmt.offset_width + 1
    ones = (1 << reach) - 1
    raw, mag = unsigned(reach), unsigned(reach)

    @always_comb
    def cut():
        raw.next = in_data[reach:]

    @always_comb
    def fold():
        if in_data[sign]:
            mag.next = raw ^ ones
        else:
            mag.next = raw

    if not activation.wide:

        @always_comb
        def address():
            base_addr.next = mag[:fine]
            slope_addr.next = concat(mag[reach:group], in_data[fine:fine_end])

        return cut, fold, address

    # The magnitude in steps of 2.
    steps, upper = unsigned(reach - FINE_WIDTH), unsigned(WIDER)
    top = (1 << WIDER) - 1
    is_wide = flag()
    switched, offset = unsigned(WIDER), unsigned(fmt.offset_width)

    @always_comb
    def rise():
        steps.next = mag[:FINE_WIDTH]

    if activation.saturates:

        @always_comb
        def saturate():
            if steps > top:
                upper.next = top
            else:
                upper.next = steps[WIDER:]

    else:

        @always_comb
        def saturate():
            upper.next = steps

    @always_comb
    def compare():
        is_wide.next = upper != 0

    @always_comb
    def switch():
        if is_wide:
            switched.next = upper
            offset.next = concat(in_data[wide:wide_end], upper[1])
        else:
            switched.next = mag[wide:fine]
            offset.next = in_data[fine:fine_end]

    @always_comb
    def address():
        base_addr.next = concat(is_wide, mag[FINE_WIDTH:wide], switched)
        slope_addr.next = concat(is_wide, mag[FINE_WIDTH:group], offset)

    return cut, fold, rise, saturate, compare, switch, address


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
    in_sign, out_sign = activation.in_fmt.width - 1, activation.out_fmt.width - 1
    base_addr = unsigned((len(bases) - 1).bit_length())
    slope_addr = unsigned((len(corrections) - 1).bit_length())
    negative, negative_late = flag(), flag()
    base, turned = unsigned(width), unsigned(width)
    slope = unsigned(activation.table.correction_width)
    wide_base, correction = signed(width + 1), signed(width + 1)
    total = signed(width + 2)
    result = unsigned(out_sign)

    @always_comb
    def look():
        negative.next = in_data[in_sign]

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
        place(in_data, base_addr, slope_addr, activation=activation),
        look,
        read(clk, base_addr, base, memory=bases),
        read(clk, slope_addr, slope, memory=corrections),
        delay(clk, None, negative, negative_late, clocks=activation.latency - 1),
        turn,
        widen,
        add,
        cut,
        keep,
    )


@block
def bipartite(clk, rst, in_valid, in_data, out_valid, out_data, *, spec: Bipartite):
    """tanh of ``in_data`` three clocks later.

    Parameters
    ----------
    in_valid, in_data : bool, signed ``spec.in_fmt``
    out_valid, out_data : bool, signed ``spec.out_fmt``
    spec : Bipartite
        Where the tables stand, and how much of them; the twin states rounding and error.

    Notes
    -----
    No multiplier. Latency: memories 1, registers behind them 1, sum 1. One result a clock. Reset
    clears the valid flags.
    """
    bases, corrections = memories(spec)
    return (
        node(clk, in_data, out_data, bases, corrections, activation=spec),
        delay(clk, rst, in_valid, out_valid, clocks=spec.latency),
    )
