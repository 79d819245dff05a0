"""pulse_density: turns codes into a bit; the density of its ones is the code."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class PulseDensity(Block):
    """A digital-to-analogue converter of one bit and of the first order (ours).

    Behind a low pass on the board, made of a resistor and a capacitor, code c becomes (c - low) /
    2**width of the voltage of the bit. The sum of all requested values minus the ones that were
    given stays below 2**width. So in any 2**width clocks with the same code there are exactly as
    many ones as the code requests, and in any other interval at most one more or one fewer.

    fmt: Format of the codes.
    """

    block = "pulse_density"
    part_of = "uart_instrument"
    area = "visualisation"
    latency = 1
    fmt: Fix

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_data", "the code, in every clock", self.fmt, "fmt"),
            output_port("out_bit", "the bit; from a register"),
        )

    def process(self, in_data: ArrayLike, reset: ArrayLike) -> Codes:
        """``out_bit`` in each clock; all arrays have one element for each clock."""
        asked = self.fmt.check(in_data, f"{self.entity} in_data") - self.fmt.low
        bits = np.zeros(len(asked), dtype=np.int64)
        total = bit = 0
        for t, (code, cleared) in enumerate(
            zip(asked.tolist(), np.asarray(reset).tolist(), strict=True)
        ):
            bits[t] = bit
            bit, total = (0, 0) if cleared else divmod(total + code, 1 << self.fmt.width)
        return bits
