"""Divider: gives the distance from the load in units of the load's half width."""

from myhdl import always, always_comb, always_seq, block, concat, instances

from golden.visualisation.divider import Divider
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.requantise import scale
from hdl.common.signals import Stream, flag, signed, unsigned


@block
def divider(clk, rst, in_: Stream, out: Stream, *, spec: Divider):
    """``in_distance`` times the gain by ``in_width``, a bit of the quotient a clock.

    Latency ``spec.out_width`` + 2 clocks: product with the gain 1, start of the remainder 1, a
    clock for each bit. Reset clears the valid flags and the count of the bits.
    """
    width_bits, out_bits = spec.width_width, spec.out_width
    shift = spec.out_frac - spec.gain_frac
    # The head has at least one bit, even where the numerator is shorter than the quotient.
    all_bits = max(spec.numerator_width + shift, out_bits + 1)
    sign = width_bits + 1
    product = unsigned(spec.numerator_width)
    numerator, aligned = unsigned(all_bits), unsigned(all_bits)
    divisor = unsigned(width_bits)
    head = unsigned(all_bits - out_bits)
    rest = unsigned(out_bits)
    load, beyond, beyond_held, fits = flag(), flag(), flag(), flag()
    remaining = unsigned(out_bits.bit_length())
    # The lower bits of the numerator leave to the left, and those of the quotient come in from the
    # right.
    digits = unsigned(out_bits)
    top = flag()
    remainder = unsigned(width_bits)
    shifted = unsigned(width_bits + 1)
    wide_shifted, wide_divisor = signed(width_bits + 2), signed(width_bits + 2)
    trial = signed(width_bits + 2)
    quotient_bit = flag()

    scale_up = scale(in_.distance, product, factor=spec.gain)
    wait = delay(clk, rst, in_.valid, load, clocks=1)

    @always(clk.posedge)
    def take():
        if in_.valid:
            numerator.next = product
            if in_.width == 0:
                divisor.next = 1
            else:
                divisor.next = in_.width

    align = ops.shift_left(numerator, shift, aligned)

    @always_comb
    def split():
        head.next = aligned[:out_bits]
        rest.next = aligned[out_bits:]

    @always_comb
    def judge():
        beyond.next = head >= divisor

    widen_shifted = connect(shifted, wide_shifted)
    widen_divisor = connect(divisor, wide_divisor)

    subtract = ops.subtract(wide_shifted, wide_divisor, trial)

    @always_comb
    def join():
        top.next = digits[out_bits - 1]

    lengthen = ops.join(remainder, top, shifted)

    @always_comb
    def decide():
        fits.next = not trial[sign]
        quotient_bit.next = beyond_held or not trial[sign]

    @always(clk.posedge)
    def step():
        if load:
            beyond_held.next = beyond
            digits.next = rest
            if beyond:
                remainder.next = 0
            else:
                remainder.next = head
        elif remaining != 0:
            digits.next = concat(digits[out_bits - 1 :], quotient_bit)
            if fits:
                remainder.next = trial[width_bits:]
            else:
                remainder.next = shifted[width_bits:]

    @always_seq(clk.posedge, reset=rst)
    def count():
        if load:
            remaining.next = out_bits
        elif remaining != 0:
            remaining.next = remaining - 1
        out.valid.next = remaining == 1 and not load

    show = ops.widen(digits, out.data)

    return instances()
