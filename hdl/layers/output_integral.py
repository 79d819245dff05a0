"""Output integral: computes the outputs in turn, with one multiplier per hidden node."""

from myhdl import always, block

from golden.layers.output_integral import OutputIntegral
from golden.layers.weighted_sum import tree_depth
from golden.numbers.fixed import Rounding
from hdl.common import ops
from hdl.common.adder_tree import adder_tree
from hdl.common.delay import delay
from hdl.common.requantise import requantise
from hdl.common.rom import rom
from hdl.common.signals import Stream, fixed, signed, unsigned


@block
def weigh(clk, addr, in_data, term, *, weights, coeff_fmt, shift: int):
    """``in_data`` times the weight of row ``addr``, two clocks later, without ``shift`` bits."""
    word, weight = fixed(coeff_fmt), fixed(coeff_fmt)
    operand = signed(len(in_data))
    product = signed(len(in_data) + coeff_fmt.width)
    words = rom(addr, word, words=weights, meanings=coeff_fmt.texts(weights))

    @always(clk.posedge)
    def fetch():
        operand.next = in_data
        weight.next = word

    @always(clk.posedge)
    def multiply():
        product.next = operand * weight

    return words, fetch, multiply, ops.shift_right(product, shift, term)


@block
def bias_term(clk, addr, term, *, biases, coeff_fmt, shift: int):
    """The bias of row ``addr`` two clocks later, moved left by ``shift`` places."""
    word, bias = fixed(coeff_fmt), fixed(coeff_fmt)
    wide = signed(coeff_fmt.width + shift)
    moved = signed(coeff_fmt.width + shift)
    words = rom(addr, word, words=biases, meanings=coeff_fmt.texts(biases))

    @always(clk.posedge)
    def keep():
        bias.next = word
        term.next = moved

    return words, ops.widen(bias, wide), ops.shift_left(wide, shift, moved), keep


@block
def scale(clk, addr, in_data, product, *, factors, width: int):
    """``in_data`` times the de-normalisation factor of row ``addr``, one clock later."""
    factor = signed(width)
    words = rom(addr, factor, words=factors, meanings=[str(f) for f in factors])

    @always(clk.posedge)
    def multiply():
        product.next = in_data * factor

    return words, multiply


@block
def output_integral(clk, rst, in_: Stream, out: Stream, *, spec: OutputIntegral):
    """One output a clock from the activations (thesis equation 5.2, Figure 5.11).

    One multiplier per hidden node, and one for the factors where there are any. Latency:
    operands 1 clock, product 1, adder tree one per level, factor 1, rounding 1. Reset clears the
    valid and last flags.
    """
    shift = spec.product_shift
    depth = tree_depth(spec.hidden + 1)
    term_width = spec.in_fmt.width + spec.coeff_fmt.width - shift
    terms = [signed(term_width) for _ in range(spec.hidden)]
    bias = signed(spec.coeff_fmt.width + spec.bias_shift)
    total = signed(spec.acc_width)
    result = fixed(spec.out_fmt)

    products = [
        weigh(
            clk,
            in_.addr,
            in_.r[j],
            terms[j],
            weights=[row[j] for row in spec.weights],
            coeff_fmt=spec.coeff_fmt,
            shift=shift,
        )
        for j in range(spec.hidden)
    ]
    biases = bias_term(
        clk, in_.addr, bias, biases=spec.biases, coeff_fmt=spec.coeff_fmt, shift=spec.bias_shift
    )
    tree = adder_tree(clk, [*terms, bias], total, width=spec.acc_width)

    scaling = []
    exact = total
    if spec.factors is not None:
        factor_width = max(spec.factors).bit_length() + 1
        exact = signed(spec.acc_width + factor_width)
        late_addr = unsigned(len(in_.addr))
        scaling = [
            delay(clk, None, in_.addr, late_addr, clocks=2 + depth),
            scale(clk, late_addr, total, exact, factors=spec.factors, width=factor_width),
        ]

    finish = requantise(exact, result, shift=spec.out_shift, rounding=Rounding.ROUND)

    @always(clk.posedge)
    def keep():
        out.data.next = result

    clocks = spec.latency
    mark = delay(clk, rst, in_.valid, out.valid, clocks=clocks)
    close = delay(clk, rst, in_.last, out.last, clocks=clocks)
    return products, biases, tree, scaling, finish, keep, mark, close
