"""The Pade activation: tanh as a fraction whose denominator is inverted by iteration."""

from myhdl import always, always_comb, always_seq, block

from golden.activation.pade import Horner, Pade
from golden.numbers.fixed import Rounding
from hdl.activation.abs_unit import abs_unit
from hdl.activation.comparator_bank import comparator_bank
from hdl.activation.sign_retriever import sign_retriever
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.requantise import requantise, scale
from hdl.common.signals import Stream, flag, signed, unsigned


@block
def multiply(clk, left, right, kept, *, shift: int, rounding):
    """``left`` times ``right``, requantised, one clock later; ``kept`` is wide enough for it."""
    exact = signed(len(left) + len(right))
    rounded = signed(len(exact) + 1 - shift)

    @always(clk.posedge)
    def product():
        exact.next = left * right

    narrow = ops.widen(rounded, kept)

    return product, requantise(exact, rounded, shift=shift, rounding=rounding), narrow


@block
def offset(data, total, *, constant: int):
    """``data`` plus a constant; ``total`` is wide enough for the sum."""
    magnitude = abs(constant)

    if constant < 0:
        return ops.subtract(data, magnitude, total)
    return ops.add(data, magnitude, total)


@block
def horner(clk, square, total, *, constants: Horner, bracket_width, twin: Pade):
    """``total`` is k0 + s (k1 + s k2), two clocks after ``square``, which is s."""
    first, second = constants.shifts(twin.square_frac)
    rounding = twin.rounding
    product = signed(len(square) + constants.k2.bit_length())
    exact = signed(len(product))
    inner = signed(max(2, len(product) + 1 - first))
    bracket = signed(bracket_width)
    late_square = signed(len(square))
    outer = signed(len(total) + 1)
    return (
        scale(square, product, factor=constants.k2),
        delay(clk, None, product, exact, clocks=1),
        requantise(exact, inner, shift=first, rounding=rounding),
        offset(inner, bracket, constant=constants.k1),
        delay(clk, None, square, late_square, clocks=1),
        multiply(clk, late_square, bracket, outer, shift=second, rounding=rounding),
        offset(outer, total, constant=constants.k0),
    )


@block
def low_signed(data, low):
    """``low`` is the low bits of ``data`` as a signed number."""
    return ops.signed_bits(data, len(low), 0, low)


@block
def low_unsigned(data, low):
    """``low`` is the low bits of ``data`` as a number that is not negative, and a sign bit of 0."""
    return ops.bits(data, len(low) - 1, 0, low)


@block
def hold(clk, enable, data, data_late):
    """``data_late`` is ``data`` of the last clock in which ``enable`` was high."""

    @always(clk.posedge)
    def keep():
        if enable:
            data_late.next = data

    return keep


@block
def regression(clk, enable, busy, ratio, value, *, twin: Pade):
    """``value`` becomes ``start`` with ``enable``, and ``start - value * ratio`` with ``busy``."""
    start = twin.start
    high = int(value.max) - 1
    low = int(value.min)
    exact = signed(len(value) + len(ratio))
    # This computes start - cut(exact) with a single row of carries. -x is the inverse of x - 1, and
    # rounding adds a half; so start, the one and the half together are one constant, which has one
    # fraction bit where the result is rounded.
    fraction = 1 if twin.rounding is Rounding.ROUND else 0
    dropped = twin.ratio.out_frac - fraction
    constant = (start << fraction) + 1
    kept = signed(len(exact) - dropped)
    less = signed(max(len(kept), constant.bit_length() + 1) + 1)
    whole = signed(len(less) - fraction)
    following = signed(len(whole))
    current = signed(len(value))

    product = ops.multiply(current, ratio, exact)
    cut = ops.shift_right(exact, dropped, kept)
    subtract = ops.subtract(kept, constant, less)
    cut_half = ops.shift_right(less, fraction, whole)
    invert = ops.invert(whole, following)

    @always(clk.posedge)
    def iterate():
        if enable:
            current.next = start
        elif busy:
            if following > high:
                current.next = high
            elif following < low:
                current.next = low
            else:
                current.next = following

    show = ops.widen(current, value)

    return product, cut, subtract, cut_half, invert, iterate, show


@block
def pade(clk, rst, in_: Stream, out: Stream, *, spec: Pade):
    """Activation of ``in_data``, the iterations and seven clocks later (4.5.2.3.3, Figure 4.20).

    Six multipliers and three multiplications by a constant. Latency ``spec.iterations`` + 7 clocks:
    ABS 1, de-normalisation 1, square 1, the two polynomials 2, q A and first step 1, the other
    steps, quotient 1, sign retriever 1. Reset clears the valid flags and the count of the steps.
    """
    rounding = spec.rounding
    iterations = spec.iterations
    mag_width, q_width = spec.abs_unit.mag_width, spec.q_width
    high = spec.out_fmt.high
    # The widths hold for every q that fits into the bits. So nothing wraps before q A and the ratio
    # are cut to the widths of those values that count: beyond them the result is a constant.
    widths = spec.widths((1 << q_width) - 1)
    mag_valid, q_valid, start, ready, result_valid = flag(), flag(), flag(), flag(), flag()
    mag, late_mag = unsigned(mag_width), unsigned(mag_width)
    negative, negative_start, negative_held, negative_late = flag(), flag(), flag(), flag()
    magnitude = Stream(valid=mag_valid, mag=mag, negative=negative)
    beyond, beyond_start = unsigned(1), unsigned(1)
    beyond_held, beyond_late = unsigned(1), unsigned(1)
    product = unsigned(max(mag_width + spec.factor.bit_length(), q_width))
    q_next, q, late_q = signed(q_width + 1), signed(q_width + 1), signed(q_width + 1)
    square = signed(widths["square"])
    all_ratio, ratio_start = signed(widths["ratio"]), signed(spec.ratio_width)
    ratio = signed(spec.ratio_width)
    numerator = signed(widths["numerator"])
    exact_dividend = signed(len(late_q) + len(numerator))
    exact_held = signed(len(exact_dividend))
    all_dividend = signed(len(exact_dividend) + 1 - spec.dividend_shift)
    dividend = signed(spec.dividend_width + 1)
    reciprocal = signed(spec.reciprocal.width)
    quotient = signed(len(dividend) + len(reciprocal))
    quotient_held = signed(len(quotient))
    kept = signed(len(quotient) + 1 - spec.out_shift)
    result = unsigned(spec.out_fmt.width - 1)
    segment = Stream(valid=q_valid, addr=beyond, mag=late_mag)
    unsigned_result = Stream(valid=result_valid, mag=result, negative=negative_late)
    remaining = unsigned(max(1, (iterations - 1).bit_length()))
    active, busy = flag(), flag()

    @always_seq(clk.posedge, reset=rst)
    def count():
        if start:
            remaining.next = iterations - 1
            active.next = True
        elif remaining != 0:
            remaining.next = remaining - 1
        else:
            active.next = False

    @always_comb
    def watch():
        busy.next = remaining != 0
        ready.next = active and remaining == 0

    @always_comb
    def choose():
        if beyond_late == 1:
            result.next = high
        elif kept < 0:
            result.next = 0
        elif kept > high:
            result.next = high
        else:
            result.next = kept

    return (
        abs_unit(clk, rst, in_, magnitude, spec=spec.abs_unit),
        comparator_bank(clk, rst, magnitude, segment, spec=spec.comparator_bank),
        scale(mag, product, factor=spec.factor),
        low_unsigned(product, q_next),
        delay(clk, None, q_next, q, clocks=1),
        multiply(clk, q, q, square, shift=spec.square_shift, rounding=rounding),
        horner(
            clk,
            square,
            all_ratio,
            constants=spec.ratio,
            bracket_width=widths["ratio_bracket"],
            twin=spec,
        ),
        low_signed(all_ratio, ratio_start),
        horner(
            clk,
            square,
            numerator,
            constants=spec.numerator,
            bracket_width=widths["numerator_bracket"],
            twin=spec,
        ),
        delay(clk, None, q, late_q, clocks=3),
        ops.multiply(late_q, numerator, exact_dividend),
        # Values of the code in the regression are held until the next code starts, and values of
        # the result until the next result is ready.
        delay(clk, rst, q_valid, start, clocks=3),
        delay(clk, None, negative, negative_start, clocks=4),
        delay(clk, None, beyond, beyond_start, clocks=3),
        hold(clk, start, negative_start, negative_held),
        hold(clk, start, beyond_start, beyond_held),
        hold(clk, start, ratio_start, ratio),
        hold(clk, start, exact_dividend, exact_held),
        requantise(exact_held, all_dividend, shift=spec.dividend_shift, rounding=rounding),
        low_unsigned(all_dividend, dividend),
        count,
        watch,
        regression(clk, start, busy, ratio, reciprocal, twin=spec),
        ops.multiply(dividend, reciprocal, quotient),
        hold(clk, ready, quotient, quotient_held),
        hold(clk, ready, negative_held, negative_late),
        hold(clk, ready, beyond_held, beyond_late),
        delay(clk, rst, ready, result_valid, clocks=1),
        requantise(quotient_held, kept, shift=spec.out_shift, rounding=rounding),
        choose,
        sign_retriever(clk, rst, unsigned_result, out, spec=spec.sign_retriever),
    )
