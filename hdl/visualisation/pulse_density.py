"""pulse_density: codes become a bit whose density is the code."""

from myhdl import always_comb, always_seq, block

from golden.visualisation.pulse_density import PulseDensity
from hdl.common.signals import flag, unsigned


@block
def pulse_density(clk, rst, in_data, out_bit, *, spec: PulseDensity):
    """A digital-to-analogue converter of one bit and the first order.

    Parameters
    ----------
    in_data : signed ``spec.fmt``
        The code, in every clock.
    out_bit : bool
        From a register; its density is the code's place between the ends of the format.
    spec : PulseDensity

    Notes
    -----
    Latency 1 clock. Reset forgets what was not given yet.
    """
    width, sign = spec.fmt.width, spec.fmt.width - 1
    # From 0 on.
    asked = unsigned(width)
    remainder = unsigned(width)
    total = unsigned(width + 1)
    given = flag()

    @always_comb
    def offset():
        asked.next = in_data[width:]
        asked.next[sign] = not in_data[sign]

    @always_comb
    def add():
        total.next = remainder + asked

    @always_seq(clk.posedge, reset=rst)
    def divide():
        remainder.next = total[width:]
        given.next = total[width]

    @always_comb
    def show():
        out_bit.next = given

    return offset, add, divide, show
