"""The Polynomial activation: tanh is approximated by two quadratics."""

from myhdl import always, always_comb, block

from golden.activation.polynomial import Polynomial
from hdl.activation.abs_unit import abs_unit
from hdl.activation.comparator_bank import comparator_bank
from hdl.activation.sign_retriever import sign_retriever
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.requantise import requantise, scale
from hdl.common.rom import rom
from hdl.common.signals import Stream, fixed, flag, signed, unsigned


@block
def square_of(clk, mag, square, *, shift: int, rounding):
    """``mag`` squared and requantised, one clock later, without bits that no quadratic needs."""
    width = len(square)
    x = signed(len(mag) + 1)
    exact = signed(2 * len(x))
    kept = signed(2 * len(x) + 1 - shift)
    x_copy = connect(mag, x)

    @always(clk.posedge)
    def multiply():
        exact.next = x * x

    finish = requantise(exact, kept, shift=shift, rounding=rounding)

    return x_copy, multiply, finish, ops.bits(kept, width, 0, square)


@block
def term(clk, addr, data, product, *, words, fmt, shift: int, rounding):
    """The constant at ``addr`` times ``data``, requantised, one clock later."""
    x = signed(len(data) + 1)
    coeff = fixed(fmt)
    exact = signed(len(x) + fmt.width)
    x_copy = connect(data, x)
    table = rom(addr, coeff, words=words, meanings=fmt.texts(words))

    @always(clk.posedge)
    def multiply():
        exact.next = x * coeff

    finish = requantise(exact, product, shift=shift, rounding=rounding)
    return x_copy, table, multiply, finish


@block
def offset(clk, addr, aligned, *, words, fmt, shift: int):
    """The constant at ``addr``, aligned to the binary point of the sum, one clock later."""
    coeff = fixed(fmt)
    late = signed(len(aligned))
    table = rom(addr, coeff, words=words, meanings=fmt.texts(words))

    @always(clk.posedge)
    def keep():
        late.next = coeff

    return table, keep, ops.shift_left(late, shift, aligned)


@block
def polynomial(clk, rst, in_: Stream, out: Stream, *, spec: Polynomial):
    """Activation of ``in_data``, five or six clocks later (thesis 4.5.2.3.2, Figure 4.19).

    Three multipliers, and one for de-normalisation where there is any. Latency: ABS 1, comparator
    bank and square 1, products 1, sum 1, de-normalisation 1 where there is any, sign retriever 1.
    One result a clock. Reset clears the valid flags.
    """
    mag_width = spec.abs_unit.mag_width
    rows = len(spec.coeffs)
    high = spec.out_fmt.high
    mag_valid, segment_valid, result_valid = flag(), flag(), flag()
    mag, late_mag = unsigned(mag_width), unsigned(mag_width)
    negative, negative_late = flag(), flag()
    magnitude = Stream(valid=mag_valid, mag=mag, negative=negative)
    segment = unsigned(spec.comparator_bank.addr_width)
    segment_late = unsigned(spec.comparator_bank.addr_width)
    square = unsigned(spec.square_width)
    # A product has the bits of operand and constant, each with a sign, and one bit for the carry of
    # the rounding.
    quadratic = signed(spec.square_width + 1 + spec.quadratic.width + 1 - spec.quadratic_shift)
    linear = signed(mag_width + 1 + spec.linear.width + 1 - spec.linear_shift)
    aligned = signed(spec.constant.width + spec.constant_shift)
    products = signed(max(len(quadratic), len(linear)) + 1)
    # The twin derives this width from the ends of all terms.
    total = signed(spec.sum_width)
    # The half LSB of rounding may be wider than the sum.
    scaled_width = spec.sum_width + (0 if spec.factor is None else spec.factor.bit_length() + 1)
    scaled = signed(scaled_width)
    kept = signed(max(2, max(scaled_width, spec.out_shift) + 1 - spec.out_shift))
    result = unsigned(spec.out_fmt.width - 1)
    placed = Stream(valid=segment_valid, addr=segment, mag=late_mag)
    unsigned_result = Stream(valid=result_valid, mag=result, negative=negative_late)
    a2, a1, a0 = zip(*spec.coeffs, strict=True)

    @always(clk.posedge)
    def add_constant():
        total.next = products + aligned

    if spec.factor is None:
        denormalise = [ops.widen(total, scaled)]
    else:
        exact = signed(scaled_width)
        denormalise = [
            scale(total, exact, factor=spec.factor),
            delay(clk, None, exact, scaled, clocks=1),
        ]

    finish = requantise(scaled, kept, shift=spec.out_shift, rounding=spec.rounding)

    @always_comb
    def choose():
        if segment_late == rows:
            result.next = high
        elif kept < 0:
            result.next = 0
        elif kept > high:
            result.next = high
        else:
            result.next = kept

    clocks = 2 + (spec.factor is not None)
    return (
        abs_unit(clk, rst, in_, magnitude, spec=spec.abs_unit),
        comparator_bank(clk, rst, magnitude, placed, spec=spec.comparator_bank),
        square_of(clk, mag, square, shift=spec.square_shift, rounding=spec.rounding),
        term(
            clk,
            segment,
            square,
            quadratic,
            words=a2,
            fmt=spec.quadratic,
            shift=spec.quadratic_shift,
            rounding=spec.rounding,
        ),
        term(
            clk,
            segment,
            late_mag,
            linear,
            words=a1,
            fmt=spec.linear,
            shift=spec.linear_shift,
            rounding=spec.rounding,
        ),
        offset(clk, segment, aligned, words=a0, fmt=spec.constant, shift=spec.constant_shift),
        ops.add(quadratic, linear, products),
        add_constant,
        denormalise,
        finish,
        choose,
        delay(clk, None, segment, segment_late, clocks=clocks),
        delay(clk, None, negative, negative_late, clocks=1 + clocks),
        delay(clk, rst, segment_valid, result_valid, clocks=clocks),
        sign_retriever(clk, rst, unsigned_result, out, spec=spec.sign_retriever),
    )
