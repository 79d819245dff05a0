"""Adder trees sum many terms, with registers at every level."""

from myhdl import always, block

from hdl.common.delay import delay
from hdl.common.signals import signed


@block
def add_pair(clk, left, right, total):
    """Registered sum of two terms."""

    @always(clk.posedge)
    def add():
        total.next = left + right

    return add


@block
def adder_tree(clk, terms, total, *, width: int):
    """``total`` is the sum of ``terms``, with one register per level.

    The caller has proved that every partial sum fits into ``width`` bits.
    """
    level = list(terms)
    adders = []
    while len(level) > 1:
        # A sum has one bit more than its wider term, but never more bits than the proved width.
        wider = min(width, max(len(t) for t in level) + 1)
        pairs = len(level) // 2
        top = len(level) == 2
        sums = [total] if top else [signed(wider) for _ in range((len(level) + 1) // 2)]
        adders += [add_pair(clk, level[2 * p], level[2 * p + 1], sums[p]) for p in range(pairs)]
        if len(level) % 2:
            adders.append(delay(clk, None, level[-1], sums[-1], clocks=1))
        level = sums
    return adders
