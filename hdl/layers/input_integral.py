"""Input integral: all nodes of the hidden layer side by side."""

from myhdl import block

from golden.layers.input_integral import InputIntegral
from hdl.common.rom import rom
from hdl.common.signals import Words, fixed
from hdl.layers.input_node import input_node


@block
def input_integral(clk, *, in_data, addr, preset, accumulate, capture, out_q, spec: InputIntegral):
    """The weighted sums of all hidden nodes (thesis section 5.4.5.1).

    One multiplier per node. Latency 4 clocks from the last sample, one sample a clock.
    """
    fmt = spec.coeff_fmt
    weight = Words(spec.hidden, lambda: fixed(fmt))
    bias = Words(spec.hidden, lambda: fixed(fmt))
    return (
        [
            rom(addr, weight[j], words=words, meanings=fmt.texts(words))
            for j, words in enumerate(spec.weights)
        ],
        # The table has the same word at every address: in MyHDL there is no other signed constant.
        [
            rom(addr, bias[j], words=[word], meanings=fmt.texts([word]))
            for j, word in enumerate(spec.biases)
        ],
        [
            input_node(
                clk,
                in_data=in_data,
                weight=weight[j],
                bias=bias[j],
                preset=preset,
                accumulate=accumulate,
                capture=capture,
                out_data=out_q[j],
                spec=spec.node,
            )
            for j in range(spec.hidden)
        ],
    )
