"""precise: computes tanh within one unit of the last place."""

from myhdl import always, always_comb, block

from golden.activation.precise import STAGES, Precise
from hdl.activation.abs_unit import abs_unit
from hdl.activation.sign_retriever import sign_retriever
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.rom import registered_rom, rom
from hdl.common.signals import Stream, flag, signed, unsigned


@block
def gated_row(clk, word, top, row, *, bit: int):
    """``row`` is ``top``, or 0 where ``bit`` of the word is set.

    Synthesis makes it a register with a synchronous reset, without a LUT.
    """

    @always(clk.posedge)
    def keep():
        if word[bit]:
            row.next = 0
        else:
            row.next = top

    return keep


@block
def row_adder(total, row, low, result):
    """One step of a multiplication: ``low`` leaves to the right, and ``row`` is added to the rest.

    If each adder had the width of the whole product, synthesis would merge them into carry-save
    adders, which take twice the LUTs.
    """
    rest = unsigned(len(total))

    @always_comb
    def shift():
        low.next = total[0]
        rest.next = total >> 1

    return shift, ops.add(rest, row, result)


@block
def precise(clk, rst, in_: Stream, out: Stream, *, spec: Precise):
    """tanh of ``in_data``, 7 clocks later with "logic" and 8 with "block_ram".

    One multiplier. Latency: ABS 1, block RAM 1 or logic 0, coefficients 1, rows 1, slope 1,
    product 1, sum 1, sign retriever 1. One result a clock. Reset clears the valid flags.
    """
    fmt, table = spec.formats, spec.table
    mag_width = spec.abs_unit.mag_width
    distance_width, top_width = fmt.distance_width, fmt.top_width
    # These are unsigned and below 1, so they are as wide as their fractions.
    intercept_width, gradient_width = fmt.intercept_frac, fmt.gradient_frac
    curve_width, slope_width = fmt.curve_width, fmt.slope_frac
    # The curve stands inverted in the word: a set bit clears a row.
    inverted = (1 << curve_width) - 1
    words = [
        (intercept << gradient_width | gradient) << curve_width | (curve ^ inverted)
        for intercept, gradient, curve in zip(
            table.intercepts, table.gradients, table.curves, strict=True
        )
    ]
    intercept_bit = gradient_width + curve_width
    word_width = intercept_bit + intercept_width
    half = 1 << (distance_width - 1)
    gradient_shift = fmt.gradient_shift
    ones = (1 << gradient_shift) - 1
    align, out_shift = fmt.intercept_shift, fmt.out_shift
    # |x| <= 2**(distance_width - 1) and slope < 2**slope_width.
    product_width = distance_width + slope_width
    aligned_width = intercept_width + align + 1
    out_width = spec.out_fmt.width - 1

    mag_valid, sum_valid = flag(), flag()
    mag = unsigned(mag_width)
    negative, negative_late = flag(), flag()
    magnitude = Stream(valid=mag_valid, mag=mag, negative=negative)
    addr = unsigned(mag_width - distance_width)
    word = unsigned(word_width)
    distance, word_distance = unsigned(distance_width), unsigned(distance_width)
    distance_late, distance_aside = unsigned(distance_width), unsigned(distance_width)
    top = unsigned(top_width)
    intercept, intercept_early = unsigned(intercept_width), unsigned(intercept_width)
    intercept_late, intercept_aside = unsigned(intercept_width), unsigned(intercept_width)
    gradient, gradient_late = unsigned(gradient_width), unsigned(gradient_width)
    rows = [unsigned(top_width) for _ in range(curve_width)]
    totals = [rows[0], *(unsigned(top_width + 1) for _ in rows[1:])]
    lows = [flag() for _ in rows[1:]]
    curve, curved = (unsigned(top_width + curve_width) for _ in range(2))
    high = unsigned(top_width + curve_width - gradient_shift)
    low, flipped = unsigned(gradient_shift), unsigned(gradient_shift)
    wide_gradient, wide_high, difference = (signed(gradient_width + 1) for _ in range(3))
    steep = unsigned(gradient_width)
    slope, slope_late = unsigned(slope_width), unsigned(slope_width)
    wide_distance = signed(distance_width + 1)
    x, x_late = signed(distance_width), signed(distance_width)
    product = signed(product_width)
    wide_intercept, aligned = signed(aligned_width), signed(aligned_width)
    total = signed(max(product_width, aligned_width) + 1)
    kept = signed(max(product_width, aligned_width) + 1 - out_shift)
    result = unsigned(out_width)
    unsigned_result = Stream(valid=sum_valid, mag=result, negative=negative_late)

    @always_comb
    def split():
        addr.next = mag[:distance_width]
        distance.next = mag[distance_width:]

    if spec.coefficients == "block_ram":
        memory = [
            registered_rom(clk, addr, word, words=words, meanings=table.meanings(fmt)),
            delay(clk, None, distance, word_distance, clocks=spec.memory_latency),
        ]
    else:
        memory = [
            rom(addr, word, words=words, meanings=table.meanings(fmt)),
            connect(distance, word_distance),
        ]

    @always_comb
    def cut_top():
        top.next = word_distance[: distance_width - top_width]

    @always(clk.posedge)
    def read():
        intercept.next = word[:intercept_bit]
        gradient.next = word[intercept_bit:curve_width]
        distance_late.next = word_distance

    gates = [gated_row(clk, word, top, rows[i], bit=i) for i in range(curve_width)]
    adders = [
        row_adder(totals[i - 1], rows[i], lows[i - 1], totals[i]) for i in range(1, curve_width)
    ]
    last = totals[-1]
    count = curve_width - 1

    @always_comb
    def assemble():
        for i in range(count):
            curve.next[i] = lows[i]
        curve.next[:count] = last

    @always(clk.posedge)
    def fold():
        # Without this register the carries of all rows and of the slope would form one path, longer
        # than any other.
        curved.next = curve
        gradient_late.next = gradient
        distance_aside.next = distance_late
        intercept_early.next = intercept

    @always_comb
    def divide():
        high.next = curved[:gradient_shift]
        low.next = curved[gradient_shift:]

    @always_comb
    def subtract():
        # It is signed, because it may be negative between two deltas of a simulation, though never
        # at a clock edge.
        difference.next = wide_gradient - wide_high

    crop = ops.bits(difference, gradient_width, 0, steep)
    flip = ops.xor(low, ones, flipped)
    fill = ops.join(steep, flipped, slope)

    @always_comb
    def widen():
        wide_distance.next = distance_aside
        wide_intercept.next = intercept_aside
        wide_gradient.next = gradient_late
        wide_high.next = high

    centre = ops.subtract(wide_distance, half, x)

    @always(clk.posedge)
    def hold():
        # Both operands come from registers, which the multipliers of FPGAs have inside.
        slope_late.next = slope
        x_late.next = x

    @always(clk.posedge)
    def multiply():
        product.next = x_late * slope_late
        intercept_aside.next = intercept_late

    move = ops.shift_left(wide_intercept, align, aligned)
    add = ops.add(product, aligned, total)
    cut = ops.shift_right(total, out_shift, kept)

    @always(clk.posedge)
    def keep():
        # The search for the coefficients has kept every result that a neuron reaches in 0 to high.
        result.next = kept[out_width:]

    clocks = spec.memory_latency + STAGES
    return (
        abs_unit(clk, rst, in_, magnitude, spec=spec.abs_unit),
        *(split, memory, cut_top, read, gates, adders, assemble, fold, divide, subtract, crop),
        *(flip, fill, widen, centre, hold, multiply, move, add, cut, keep),
        # This data has a reset, because without one this chain would be put into LUTs on Series 7.
        delay(clk, rst, intercept_early, intercept_late, clocks=1),
        delay(clk, rst, mag_valid, sum_valid, clocks=clocks),
        delay(clk, None, negative, negative_late, clocks=clocks),
        sign_retriever(clk, rst, unsigned_result, out, spec=spec.sign_retriever),
    )
