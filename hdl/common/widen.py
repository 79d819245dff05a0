"""Turns an unsigned signal into a signed one."""

from myhdl import always_comb, block


@block
def widen(data, wide):
    """``wide`` has the value of the unsigned ``data``; it is signed and at least a bit wider."""

    @always_comb
    def copy():
        wide.next = data

    return copy
