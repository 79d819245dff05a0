"""table_address: which segment of tanh's table a hidden sum lies in."""

from myhdl import always_comb, block

from golden.engine.formats import HIDDEN
from golden.engine.table_address import TableAddress
from hdl.common.signals import unsigned


@block
def table_address(q, addr, *, spec: TableAddress):
    """The high bits of ``q``, complemented where it is below 0, up to the last segment.

    Parameters
    ----------
    q : signed Fix(18,14)
    addr : unsigned ``spec.addr_width`` bits
    spec : TableAddress
    """
    sign = HIDDEN.width - 1
    low = spec.segment_width
    width = sign - low
    part, high = unsigned(width), unsigned(width)
    last = spec.segments - 1
    addr_width = spec.addr_width

    @always_comb
    def cut():
        part.next = q[sign:low]

    @always_comb
    def complement():
        if q[sign]:
            high.next = ~part
        else:
            high.next = part

    @always_comb
    def address():
        if high > last:
            addr.next = last
        else:
            addr.next = high[addr_width:]

    return cut, complement, address
