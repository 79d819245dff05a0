"""Divider: computes the distance from the load in units of its half width."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border, border_among
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, check_unsigned


@dataclass(frozen=True)
class Divider(Block):
    """t = distance * gain / width, one bit per clock: the C (i_p - i_m) of equation 3.18.

    Shifting and subtracting gives the quotient exactly, apart from rounding down, for narrow and
    wide loads alike. A table of reciprocals would need a shifter for narrow loads and a multiplier,
    and would only be exact up to its last address.

    distance_width: Bits of the unsigned distance ``|i_p - i_m|``.
    width_width: Bits of the unsigned width.
    gain: The constant, unsigned, with ``gain_frac`` fraction bits.
    out_width, out_frac: Format of the unsigned quotient t.

    Distance and width share one binary point. A width of 0 counts as 1 LSB, which is the narrowest
    load. The quotient is truncated and saturates to 2**out_width - 1.
    """

    block = "divider"
    section = "5.8"
    area = "visualisation"
    distance_width: int
    width_width: int
    gain: int
    gain_frac: int
    out_width: int
    out_frac: int

    def __post_init__(self) -> None:
        self.check(gain=(1, None), gain_frac=(0, self.out_frac), out_frac=(0, self.out_width - 1))

    @property
    def interval(self) -> int:
        """Least clocks from one quotient to the next."""
        return self.out_width + 1

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "distance and width are there, for this clock"),
            input_port("in_distance", "distance from the load", Unsigned(self.distance_width)),
            input_port(
                "in_width",
                "width, with the binary point of the distance",
                Unsigned(self.width_width),
            ),
            output_port("out_valid", "`out_data` holds a new quotient"),
            output_port("out_data", "quotient t", Unsigned(self.out_width, self.out_frac)),
        )

    @property
    def latency(self) -> int:
        # One clock for the product with the gain, one to start the remainder, and one for each bit.
        return 2 + self.out_width

    @property
    def numerator_width(self) -> int:
        """Bits of distance * gain, before the zeros that become the quotient's fraction."""
        return (((1 << self.distance_width) - 1) * self.gain).bit_length()

    @property
    def borders(self) -> tuple[Border, ...]:
        return (border_among("saturates", "quotient", 1 << self.out_width, self.about_border[2]),)

    @property
    def about_border(self) -> tuple[Codes, Codes, Codes]:
        """For every width the two distances around which the quotient saturates, with quotients."""
        widths = np.arange(1, 1 << self.width_width, dtype=np.int64)
        step = self.gain << (self.out_frac - self.gain_frac)
        first = -(-(widths << self.out_width) // step)
        distances, width = np.concatenate([first - 1, first]), np.tile(widths, 2)
        there = distances < 1 << self.distance_width
        distances, width = distances[there], width[there]
        return distances, width, self.quotient(distances, width)

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        return {"quotient": self.quotient(*inputs)}

    def quotient(self, distance: Codes, width: Codes) -> Codes:
        """The quotient before it saturates."""
        numerator = (distance * self.gain) << (self.out_frac - self.gain_frac)
        return np.asarray(numerator // np.maximum(width, 1), dtype=np.int64)

    def process(self, distance: ArrayLike, width: ArrayLike) -> Codes:
        """The quotients; the arguments are broadcast."""
        u = check_unsigned(distance, self.distance_width, "divider distance")
        w = check_unsigned(width, self.width_width, "divider width")
        most = (1 << self.out_width) - 1
        return np.asarray(np.minimum(self.quotient(u, w), most), dtype=np.int64)
