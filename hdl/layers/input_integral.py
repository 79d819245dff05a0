"""Input integral: all nodes of the hidden layer side by side."""

from myhdl import block

from golden.layers.input_integral import InputIntegral
from hdl.layers.input_node import input_node


@block
def input_integral(clk, in_data, addr, preset, accumulate, capture, out_q, *, spec: InputIntegral):
    """The weighted sums of all hidden nodes (thesis section 5.4.5.1).

    Parameters
    ----------
    in_data, addr, preset, accumulate, capture
        As for ``input_node``; every node takes the same.
    out_q : Words of signed
        One held sum per node: ports ``out_q_0``, ``out_q_1``, ...
    spec : InputIntegral

    Notes
    -----
    One multiplier per node. Latency 4 clocks from the last sample, one sample a clock.
    """
    return [
        input_node(clk, in_data, addr, preset, accumulate, capture, out_q[j], spec=node)
        for j, node in enumerate(spec.nodes)
    ]
