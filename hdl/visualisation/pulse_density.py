"""pulse_density: turns codes into a bit whose density of ones follows the code."""

from myhdl import always_comb, always_seq, block

from golden.instruments.uart_instrument import PulseDensity
from hdl.common import ops
from hdl.common.signals import flag, unsigned


@block
def pulse_density(clk, rst, in_data, out_bit, *, spec: PulseDensity):
    """A digital-to-analogue converter of one bit and the first order.

    Latency 1 clock. Reset forgets what was not given yet.
    """
    width, sign = spec.fmt.width, spec.fmt.width - 1
    # The code, counted from the lower end of the format.
    asked = unsigned(width)
    remainder = unsigned(width)
    total = unsigned(width + 1)
    given = flag()

    @always_comb
    def offset():
        asked.next = in_data[width:]
        asked.next[sign] = not in_data[sign]

    @always_seq(clk.posedge, reset=rst)
    def divide():
        remainder.next = total[width:]
        given.next = total[width]

    return offset, ops.add(remainder, asked, total), divide, ops.widen(given, out_bit)
