"""pulse_density: codes become a bit whose density is the code."""

from myhdl import always_comb, always_seq, block

from golden.visualisation.pulse_density import PulseDensity
from hdl.common.signals import fixed, flag, unsigned


@block
def pulse_density(clk, rst, in_valid, in_data, out_bit, *, spec: PulseDensity):
    """A digital-to-analogue converter of one bit and the first order.

    Parameters
    ----------
    in_valid, in_data : bool, signed ``spec.fmt``
        A code, which is given until the next one comes.
    out_bit : bool
        From a register; its density is the code's place between the ends of the format.
    spec : PulseDensity

    Notes
    -----
    Latency 2 clocks. Reset gives code 0, which is half of the voltage.
    """
    width, sign = spec.fmt.width, spec.fmt.width - 1
    code = fixed(spec.fmt)
    # From 0 on.
    asked = unsigned(width)
    remainder = unsigned(width)
    total = unsigned(width + 1)
    given = flag()

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if in_valid:
            code.next = in_data

    @always_comb
    def offset():
        asked.next = code[width:]
        asked.next[sign] = not code[sign]

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

    return keep, offset, add, divide, show
