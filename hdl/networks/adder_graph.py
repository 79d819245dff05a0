"""Adder graph: a network of any depth without a multiplier, a frame every clock."""

from myhdl import always, block

from golden.activation.bipartite import NODES, RESULT
from golden.networks.adder_graph import AdderGraph
from golden.numbers.precision import SIGNAL
from hdl.activation.bipartite import bipartite
from hdl.activation.bipartite_pair import bipartite_pair
from hdl.common.delay import connect, delay
from hdl.common.signals import Stream, Words, fixed, flag
from hdl.layers.argmax_tree import argmax_tree
from hdl.layers.constant_matrix import constant_matrix


@block
def never(clk, error):
    """``error`` is always low."""

    @always(clk.posedge)
    def hold():
        error.next = False

    return hold


def order(spec: AdderGraph, n: int) -> tuple[bool, int]:
    """The place of a layer among the entities, because proofs of a block are of its first entity.

    The first layer with a finish comes first, since its samples have all codes. Without one it is
    the last layer, which saturates.
    """
    finished = bool(spec.layers[n].finishes)
    return not finished, n if finished else -n


def spans(words: Words, counts: list[int]) -> list[Words]:
    """The words in groups of so many, one behind the other."""
    there = iter([words[i] for i in range(len(words))])
    return [Words(count, lambda: next(there)) for count in counts]


def waits(spec: AdderGraph, in_valid, asked: list, answers: list, out_valid) -> list[tuple]:
    """The delays of the flag between tables: what is delayed, what it becomes, and the clocks.

    For each layer with tables, ``asked`` has the flag in front of them, and ``answers`` that of
    their results.
    """
    found, before, clocks = [], in_valid, 0
    flags = iter(zip(asked, answers, strict=True))
    for matrix, tables in zip(spec.layers, spec.activations, strict=False):
        clocks += matrix.latency
        if tables:
            ask, answer = next(flags)
            found.append((before, ask, clocks))
            before, clocks = answer, 0
    return [*found, (before, out_valid, clocks + spec.layers[-1].latency)]


@block
def adder_graph(
    clk, rst, in_: Stream, out: Stream, *, frame_error, winner: Stream, spec: AdderGraph
):
    """A frame of samples in one clock, all outputs in another, without a multiplier.

    Latency: ``spec.latency`` clocks, a frame every clock. Reset clears the valid flags.
    """
    # The results of all hidden matrices, and those of all tables, layer by layer.
    formats = iter([m.out_fmt for m in spec.layers[:-1] for _ in m.weights])
    q = Words(sum(len(m.weights) for m in spec.layers[:-1]), lambda: fixed(next(formats)))
    r = Words(sum(map(len, spec.activations)), lambda: fixed(RESULT))
    sums = spans(q, [len(m.weights) for m in spec.layers[:-1]])
    tabled = spans(r, list(map(len, spec.activations)))
    taken = [in_.data, *(b if len(b) else a for a, b in zip(sums, tabled, strict=True))]
    # An output port cannot be read.
    y = Words(spec.outputs if spec.argmax else 0, lambda: fixed(SIGNAL))
    given = [*sums, y if spec.argmax else out.data]
    y_valid = flag()

    groups = [(n, nodes) for n, layer in enumerate(spec.groups) for nodes in layer]
    tables = [spec.shared(*group) for group in groups]
    # Each q with only those bits that its values can need.
    short = [
        Words(len(nodes), lambda fmt=spec.activations[n][nodes[0]].in_fmt: fixed(fmt))
        for n, nodes in groups
    ]
    result = [Words(len(nodes), lambda: fixed(RESULT)) for _, nodes in groups]
    places = [(g, i, n, j) for g, (n, nodes) in enumerate(groups) for i, j in enumerate(nodes)]
    # The first table of each layer that has tables, and the number of that layer among these.
    firsts = [g for g, (n, _) in enumerate(groups) if not g or groups[g - 1][0] != n]
    layer_of = [sum(first <= g for first in firsts) - 1 for g in range(len(groups))]
    q_valid, r_valid = flag(), Words(len(tables), flag)
    later_valid = Words(max(0, len(firsts) - 1), flag)
    asked = [q_valid, *(later_valid[n] for n in range(len(later_valid)))][: len(firsts)]
    answers = [r_valid[first] for first in firsts]
    flags = waits(spec, in_.valid, asked, answers, y_valid if spec.argmax else out.valid)
    return (
        [
            constant_matrix(clk, taken[n], given[n], spec=spec.layers[n])
            for n in sorted(range(len(taken)), key=lambda n: order(spec, n))
        ],
        [delay(clk, rst, before, late, clocks=clocks) for before, late, clocks in flags[:-1]],
        [connect(sums[n][j], short[g][i]) for g, i, n, j in places],
        [
            bipartite_pair(
                clk,
                rst,
                Stream(valid=asked[layer_of[g]], data=short[g]),
                Stream(valid=r_valid[g], data=result[g]),
                spec=table,
            )
            if len(result[g]) == NODES
            else bipartite(
                clk,
                rst,
                Stream(valid=asked[layer_of[g]], data=short[g][0]),
                Stream(valid=r_valid[g], data=result[g][0]),
                spec=table,
            )
            for g, table in enumerate(tables)
        ],
        [connect(result[g][i], tabled[n][j]) for g, i, n, j in places],
        [delay(clk, rst, before, late, clocks=clocks) for before, late, clocks in flags[-1:]],
        never(clk, frame_error),
        [
            [connect(y[i], out.data[i]) for i in range(len(y))],
            connect(y_valid, out.valid),
            argmax_tree(clk, y, winner, spec=spec.argmax),
            delay(clk, rst, y_valid, winner.valid, clocks=spec.argmax.latency),
        ]
        if spec.argmax
        else [],
    )
