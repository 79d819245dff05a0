"""bipartite_pair: computes tanh of two nodes from one pair of tables."""

from myhdl import block

from golden.activation.bipartite import NODES, BipartitePair
from hdl.activation.bipartite import memories, node
from hdl.common.delay import delay
from hdl.common.signals import Stream


@block
def bipartite_pair(clk, rst, in_: Stream, out: Stream, *, spec: BipartitePair):
    """tanh of both of ``in_data`` four clocks later.

    Two memories with two read ports each, and whatever else of ``bipartite`` twice. Latency as
    there, one result of either a clock. Reset clears the valid flags.
    """
    memory = memories(spec.activation)
    return (
        [
            node(clk, in_.data[n], out.data[n], memory, activation=spec.activation)
            for n in range(NODES)
        ],
        delay(clk, rst, in_.valid, out.valid, clocks=spec.latency),
    )
