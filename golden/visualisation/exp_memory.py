"""exp_memory: holds exp(-x) for the middle of every interval of x."""

from fractions import Fraction

from golden.activation.rom import Rom
from golden.common.port import CLOCK, Port
from golden.numbers.fixed import Rounding, cut
from golden.numbers.transcendental import exp_floors


class ExpMemory(Rom):
    """ROM of exp(-x), addressed by the upper bits of x (thesis section 5.8, Figure 5.25).

    Unlike other ROMs it is read with a clock, because it is a block RAM.
    """

    block = "exp_memory"
    part_of = "load_profile"
    section = "5.8"
    area = "visualisation"
    port_meanings = ("upper bits of x", "exp(-x) in the middle of the interval")
    latency = 1

    @property
    def ports(self) -> tuple[Port, ...]:
        return CLOCK, *super().ports


def exp_memory(addr_width: int, interval_frac: int, width: int) -> ExpMemory:
    """The memory of 2**addr_width words, each for an interval of 2**-interval_frac.

    Word n is exp(-(n + 1/2) / 2**interval_frac), unsigned with ``width`` fraction bits, rounded to
    nearest. It is below 1, so ``width`` bits hold it. 1024 words of 17 bits are one block RAM.
    """
    interval = Fraction(1, 1 << interval_frac)
    floors = exp_floors(interval / 2, interval, 1 << addr_width, width + 1)
    return ExpMemory(tuple(cut(floors, 1, Rounding.ROUND).tolist()), width, width)
