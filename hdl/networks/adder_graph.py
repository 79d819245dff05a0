"""Adder graph: a network of two layers without a multiplier, a frame every clock."""

from myhdl import always, block

from golden.activation.bipartite_pair import NODES
from golden.networks.adder_graph import AdderGraph
from hdl.activation.bipartite import bipartite
from hdl.activation.bipartite_pair import bipartite_pair
from hdl.common.delay import connect, delay
from hdl.common.signals import Stream, Words, fixed, flag
from hdl.layers.constant_matrix import constant_matrix


@block
def never(clk, error):
    """``error`` is always low."""

    @always(clk.posedge)
    def hold():
        error.next = False

    return hold


@block
def adder_graph(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: AdderGraph):
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
        It is always low, because every frame is good.
    spec : AdderGraph

    Notes
    -----
    Latency: ``spec.latency`` clocks, a frame every clock. Reset clears the valid flags.
    """
    hidden = len(spec.activations)
    q = Words(hidden, lambda: fixed(spec.first.out_fmt))
    r = Words(hidden, lambda: fixed(spec.second.in_fmt))
    q_valid = flag()
    tables = [spec.shared(nodes) for nodes in spec.groups]
    # Each q with only those bits that its values can need.
    short = [
        Words(len(nodes), lambda fmt=spec.activations[nodes[0]].in_fmt: fixed(fmt))
        for nodes in spec.groups
    ]
    result = [Words(len(nodes), lambda: fixed(spec.second.in_fmt)) for nodes in spec.groups]
    r_valid = Words(len(tables), flag)
    places = [(n, i, j) for n, nodes in enumerate(spec.groups) for i, j in enumerate(nodes)]
    return (
        # The layer that saturates comes first, because proofs of a block are made of its first
        # entity.
        constant_matrix(clk, r, out.data, spec=spec.second),
        constant_matrix(clk, in_.data, q, spec=spec.first),
        delay(clk, rst, in_.valid, q_valid, clocks=spec.first.latency),
        [connect(q[j], short[n][i]) for n, i, j in places],
        [
            bipartite_pair(
                clk,
                rst,
                Stream(valid=q_valid, data=short[n]),
                Stream(valid=r_valid[n], data=result[n]),
                spec=table,
            )
            if len(result[n]) == NODES
            else bipartite(
                clk,
                rst,
                Stream(valid=q_valid, data=short[n][0]),
                Stream(valid=r_valid[n], data=result[n][0]),
                spec=table,
            )
            for n, table in enumerate(tables)
        ],
        [connect(result[n][i], r[j]) for n, i, j in places],
        delay(clk, rst, r_valid[0], out.valid, clocks=spec.second.latency),
        never(clk, frame_error),
    )
