"""Adder graph: a network of two layers without a multiplier, a frame every clock."""

from myhdl import always, block

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_pair import NODES, BipartitePair
from golden.networks.adder_graph import AdderGraph
from golden.precision import SIGNAL
from hdl.activation.bipartite import bipartite
from hdl.activation.bipartite_pair import bipartite_pair
from hdl.common.delay import connect, delay
from hdl.common.signals import Words, fixed, flag
from hdl.layers.constant_matrix import constant_matrix


@block
def never(clk, error):
    """``error`` is low."""

    @always(clk.posedge)
    def hold():
        error.next = False

    return hold


@block
def tanh_of(clk, rst, q_valid, q, r_valid, r, *, spec: Bipartite | BipartitePair):
    """The activation of one node or of a pair, of as many bits of q as the nodes can have.

    ``q`` and ``r`` are lists of signals.
    """
    count = len(q)
    activation = spec.activation if count == NODES else spec
    short = Words(count, lambda: fixed(activation.in_fmt))
    result = Words(count, lambda: fixed(activation.out_fmt))
    if count == NODES:
        shared = bipartite_pair(clk, rst, q_valid, short, r_valid, result, spec=spec)
    else:
        shared = bipartite(clk, rst, q_valid, short[0], r_valid, result[0], spec=spec)
    return (
        [connect(q[n], short[n]) for n in range(count)],
        shared,
        [connect(result[n], r[n]) for n in range(count)],
    )


@block
def adder_graph(clk, rst, in_valid, in_data, out_valid, out_data, frame_error, *, spec: AdderGraph):
    """A frame of samples in one clock, all outputs in another, without a multiplier.

    Parameters
    ----------
    in_valid : bool
        The samples of a frame stand on all ports of ``in_data``.
    in_data : Words of signed Fix(14,13)
        Ports ``in_data_0``, ``in_data_1``, ..., in the order of the sensors.
    out_valid, out_data : bool, Words of signed Fix(14,13)
        The outputs, ports ``out_data_0``, ``out_data_1``, ...
    frame_error : bool
        Always low: every frame is good.
    spec : AdderGraph

    Notes
    -----
    Latency: ``spec.latency`` clocks, a frame every clock. Reset clears the valid flags.
    """
    hidden = len(spec.activations)
    q = Words(hidden, lambda: fixed(spec.first.out_fmt))
    r = Words(hidden, lambda: fixed(SIGNAL))
    q_valid = flag()
    r_valid = Words(len(spec.groups), flag)
    return (
        constant_matrix(clk, in_data, q, spec=spec.first),
        delay(clk, rst, in_valid, q_valid, clocks=spec.first.latency),
        [
            tanh_of(
                clk,
                rst,
                q_valid,
                [q[j] for j in nodes],
                r_valid[n],
                [r[j] for j in nodes],
                spec=spec.shared(nodes),
            )
            for n, nodes in enumerate(spec.groups)
        ],
        constant_matrix(clk, r, out_data, spec=spec.second),
        delay(clk, rst, r_valid[0], out_valid, clocks=spec.second.latency),
        never(clk, frame_error),
    )
