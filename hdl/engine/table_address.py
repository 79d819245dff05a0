"""table_address: finds the segment of a table in which a hidden sum lies."""

from myhdl import always, always_comb, block

from golden.engine.datapath import TableAddress
from golden.engine.formats import HIDDEN
from hdl.common import ops
from hdl.common.signals import unsigned


@block
def table_address(clk, q, addr, *, spec: TableAddress):
    """The high bits of ``q``, complemented where it is below 0, up to the last segment."""
    sign = HIDDEN.width - 1
    low = spec.segment_width
    width = sign - low
    part, high = unsigned(width), unsigned(width)
    last = spec.segments - 1
    addr_width = spec.addr_width

    @always_comb
    def complement():
        if q[sign]:
            high.next = ~part
        else:
            high.next = part

    # The ones at the end of the last address need not be compared. A comparison would be a row of
    # carries.
    ones = (~last & (last + 1)).bit_length() - 1
    most = last >> ones
    top = unsigned(width - ones)

    @always(clk.posedge)
    def address():
        if top > most:
            addr.next = last
        else:
            addr.next = high[addr_width:]

    return ops.bits(q, sign, low, part), complement, ops.bits(high, width, ones, top), address
