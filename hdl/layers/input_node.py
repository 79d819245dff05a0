"""One node of the input integral: a neuron's weighted sum of serial samples."""

from myhdl import always, always_comb, block

from golden.layers.input_integral import InputNode
from golden.numbers.fixed import Rounding
from hdl.common import ops
from hdl.common.requantise import requantise
from hdl.common.signals import fixed, signed


@block
def input_node(
    clk, *, in_data, weight, bias, preset, accumulate, capture, out_data, spec: InputNode
):
    """Bias plus weighted sum of the samples of a frame (thesis equation 5.1, Figure 5.9).

    One multiplier. Latency 4 clocks from the last sample to ``out_data`` (operands, product,
    accumulator, output), one sample a clock. No reset: the controls that CONTROLLER 1 makes carry
    the state.
    """
    shift = spec.product_shift
    align = spec.bias_shift
    product_width = spec.in_fmt.width + spec.coeff_fmt.width

    sample = signed(spec.in_fmt.width)
    factor = fixed(spec.coeff_fmt)
    product = signed(product_width)
    term = signed(product_width - shift)
    bias_word = signed(spec.acc_width)
    start = signed(spec.acc_width)
    base = signed(spec.acc_width)
    total = signed(spec.acc_width)
    acc = signed(spec.acc_width)
    result = fixed(spec.out_fmt)

    @always(clk.posedge)
    def fetch():
        # Both operands come from registers, which the multipliers of FPGAs have inside.
        sample.next = in_data
        factor.next = weight

    @always(clk.posedge)
    def multiply():
        product.next = sample * factor

    cut = ops.shift_right(product, shift, term)
    widen = ops.widen(bias, bias_word)
    move = ops.shift_left(bias_word, align, start)

    @always_comb
    def choose():
        if preset:
            base.next = start
        else:
            base.next = acc

    @always_comb
    def add():
        # acc_width holds every partial sum (InputNode.acc_width).
        total.next = base + term

    @always(clk.posedge)
    def gather():
        if accumulate:
            acc.next = total

    finish = requantise(acc, result, shift=spec.out_shift, rounding=Rounding.ROUND)

    @always(clk.posedge)
    def hold():
        if capture:
            out_data.next = result

    return fetch, multiply, cut, widen, move, choose, add, gather, finish, hold
