"""Argmax tree: the largest of outputs that come all at once, and how far the next is behind it."""

from myhdl import always, always_comb, block

from golden.layers.argmax import ArgmaxTree
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.signals import Stream, fixed, flag, signed, unsigned


@block
def pair(clk, one, other, winner: Stream):
    """The larger of two outputs, with its number in the pair, and the smaller, one clock later."""
    loses = flag()

    @always(clk.posedge)
    def keep():
        if loses:
            winner.top.next = other
            winner.second.next = one
            winner.index.next = 1
        else:
            winner.top.next = one
            winner.second.next = other
            winner.index.next = 0

    return ops.less(one, other, loses), keep


@block
def alone(clk, one, winner: Stream, *, low: int):
    """An output without another to meet; the second is the lowest there can be."""

    @always(clk.posedge)
    def keep():
        winner.top.next = one
        winner.second.next = low
        winner.index.next = 0

    return keep


@block
def meet(clk, one: Stream, other: Stream, winner: Stream, *, place: int):
    """What two groups of outputs have in common, one clock later; the first of equal ones wins.

    ``place`` is the number of outputs in the first group.
    """
    loses, closer = flag(), flag()
    rival, second = signed(len(one.top)), signed(len(one.top))

    compare = ops.less(one.top, other.top, loses)

    # The loser is behind the winner, and so is the second of the winner's own group.
    @always_comb
    def choose():
        if loses:
            rival.next = one.top
            second.next = other.second
        else:
            rival.next = other.top
            second.next = one.second

    look = ops.less(rival, second, closer)

    @always(clk.posedge)
    def follow():
        if closer:
            winner.second.next = second
        else:
            winner.second.next = rival

    @always(clk.posedge)
    def lead():
        if loses:
            winner.top.next = other.top
            winner.index.next = other.index | place
        else:
            winner.top.next = one.top
            winner.index.next = one.index

    return compare, choose, look, follow, lead


@block
def stay(clk, one: Stream, winner: Stream):
    """A group of outputs without another to meet."""

    @always(clk.posedge)
    def keep():
        winner.top.next = one.top
        winner.second.next = one.second
        winner.index.next = one.index

    return keep


@block
def subtract(clk, last: Stream, margin):
    """How far the second is below the largest, one clock later."""
    width = len(margin)
    lead = signed(width + 1)

    @always(clk.posedge)
    def keep():
        margin.next = lead[width:]

    return ops.subtract(last.top, last.second, lead), keep


@block
def argmax_tree(clk, in_data, out: Stream, *, spec: ArgmaxTree):
    """Index and margin of the largest of the outputs that come in one clock.

    A frame every clock. No reset: data alone.
    """
    count = spec.outputs
    # For each level the groups of outputs that are left behind it.
    counts = [-(-count >> level + 1) for level in range(spec.levels)]
    groups = [
        [
            Stream(top=fixed(spec.fmt), second=fixed(spec.fmt), index=unsigned(len(out.index)))
            for _ in range(left)
        ]
        for left in counts
    ]
    return (
        [
            pair(clk, in_data[2 * n], in_data[2 * n + 1], groups[0][n])
            if 2 * n + 1 < count
            else alone(clk, in_data[2 * n], groups[0][n], low=spec.fmt.low)
            for n in range(counts[0])
        ],
        [
            meet(clk, before[2 * n], before[2 * n + 1], group, place=2 << level)
            if 2 * n + 1 < len(before)
            else stay(clk, before[2 * n], group)
            for level, before in enumerate(groups[:-1])
            for n, group in enumerate(groups[level + 1])
        ],
        subtract(clk, groups[-1][0], out.margin),
        delay(clk, None, groups[-1][0].index, out.index, clocks=1),
    )
