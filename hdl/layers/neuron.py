"""Neuron: a weighted sum of samples that come all at once."""

from myhdl import always, block

from golden.layers.weighted_sum import tree_depth
from golden.networks.parallel import Neuron
from golden.numbers.fixed import Rounding
from hdl.common import ops
from hdl.common.adder_tree import adder_tree
from hdl.common.delay import connect, delay
from hdl.common.requantise import requantise, scale
from hdl.common.signals import fixed, signed


@block
def weigh(clk, data, term, *, weight: int, width: int, shift: int):
    """``data`` times a constant of ``width`` bits, without ``shift`` bits, one clock later."""
    # VHDL converts a number to the width of the signal that it multiplies, so this signal must be
    # wide enough for the constant, too.
    wide = signed(max(len(data), width))
    product = signed(len(data) + width)

    @always(clk.posedge)
    def multiply():
        product.next = wide * weight

    return ops.widen(data, wide), multiply, ops.shift_right(product, shift, term)


@block
def constant(clk, term, *, value: int, width: int, shift: int):
    """``value`` moved left by ``shift`` places; a register holds it, so that it has a driver."""
    # The signal is shifted and not the number, which may then exceed 2**30: up to there MyHDL
    # converts literals correctly.
    word = signed(width + shift)

    @always(clk.posedge)
    def keep():
        word.next = value

    return keep, ops.shift_left(word, shift, term)


@block
def neuron(clk, in_data, out_data, *, spec: Neuron):
    """Bias plus weighted sum of a frame, times a factor (thesis section 5.2.1, Figures 5.1, 5.2).

    One multiplier per weight that is not 0, and one for the factor where there is one. Latency:
    product 1 clock, adder tree one per level, factor 1, rounding 1; one frame a clock. No reset:
    data alone.
    """
    coeff_width = spec.coeff_fmt.width
    shift = spec.product_shift
    term_width = spec.in_fmt.width + coeff_width - shift
    # A weight of 0 adds nothing. One term stays even so, because a sum needs two.
    kept = [k for k, weight in enumerate(spec.weights) if weight] or [0]
    for k in range(len(spec.weights)):
        # MyHDL refuses a port that nothing reads.
        in_data[k].read = True
    terms = [signed(term_width) for _ in kept]
    bias = signed(coeff_width + spec.bias_shift)
    summed, total = signed(spec.acc_width), signed(spec.acc_width)
    result = fixed(spec.out_fmt)
    products = [
        weigh(clk, in_data[k], terms[i], weight=spec.weights[k], width=coeff_width, shift=shift)
        for i, k in enumerate(kept)
    ]
    offset = constant(clk, bias, value=spec.bias, width=coeff_width, shift=spec.bias_shift)
    tree = adder_tree(clk, [*terms, bias], summed, width=spec.acc_width)
    # The sum is as late as it would be with all terms, so that all neurons of a layer have the same
    # latency.
    late = tree_depth(len(spec.weights) + 1) - tree_depth(len(terms) + 1)
    wait = delay(clk, None, summed, total, clocks=late) if late else connect(summed, total)

    scaling = []
    exact = total
    if spec.factor is not None:
        product, exact = signed(spec.scaled_width), signed(spec.scaled_width)
        scaling = [
            scale(total, product, factor=spec.factor),
            delay(clk, None, product, exact, clocks=1),
        ]

    finish = requantise(exact, result, shift=spec.out_shift, rounding=Rounding.ROUND)

    @always(clk.posedge)
    def keep():
        out_data.next = result

    return products, offset, tree, wait, scaling, finish, keep
