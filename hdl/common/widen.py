"""An unsigned signal as a signed one."""

from myhdl import always_comb, block


@block
def widen(data, wide):
    """``wide``, signed and at least a bit wider, is the unsigned ``data``."""

    @always_comb
    def copy():
        wide.next = data

    return copy
