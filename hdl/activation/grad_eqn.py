"""GRAD_EQN: computes gradient times magnitude plus intercept."""

from myhdl import always, block

from golden.activation.grad_eqn import GradEqn
from golden.numbers.fixed import Rounding
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.signals import Stream, unsigned


@block
def grad_eqn(clk, rst, in_: Stream, out: Stream, *, spec: GradEqn):
    """``in_coeff * in_mag + in_intercept`` three clocks later (equation 4.23, section 5.4.5.2).

    One multiplier. Latency 3 clocks (operands, product, sum), one result a clock. Reset clears
    ``out_valid`` and the flags on their way to it.
    """
    product_width = spec.mag_width + spec.coeff_width
    aligned_width = spec.intercept_width + spec.intercept_shift
    # The sum of two numbers below 2**w and 2**v and of half an LSB stays below 2**(max(w, v) + 1).
    total_width = max(product_width, aligned_width) + 1
    shift = spec.out_shift
    align = spec.intercept_shift
    half = (1 << shift) >> 1 if spec.rounding is Rounding.ROUND else 0

    mag, coeff = unsigned(spec.mag_width), unsigned(spec.coeff_width)
    product = unsigned(product_width)
    early_intercept = unsigned(spec.intercept_width)
    intercept = unsigned(spec.intercept_width)
    wide_intercept = unsigned(aligned_width)
    aligned = unsigned(aligned_width)
    total = unsigned(total_width)
    rounded = unsigned(total_width)
    out_width = spec.out_fmt.width - 1
    kept = unsigned(max(out_width, total_width - shift))

    @always(clk.posedge)
    def fetch():
        # Both operands come from registers, which the multipliers of FPGAs have inside.
        mag.next = in_.mag
        coeff.next = in_.coeff
        early_intercept.next = in_.intercept

    @always(clk.posedge)
    def multiply():
        product.next = mag * coeff
        intercept.next = early_intercept

    widen = ops.widen(intercept, wide_intercept)
    move = ops.shift_left(wide_intercept, align, aligned)
    add = ops.add(product, aligned, total)
    add_half = ops.add(total, half, rounded)
    cut = ops.shift_right(rounded, shift, kept)

    @always(clk.posedge)
    def keep():
        # segments.py proves that no magnitude that the neuron reaches has a bit above these.
        out.data.next = kept[out_width:]

    mark = delay(clk, rst, in_.valid, out.valid, clocks=3)
    return fetch, multiply, widen, move, add, add_half, cut, keep, mark
