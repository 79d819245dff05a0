"""ABS: sign and magnitude of a signed code."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.border import Border
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class AbsUnit(Block):
    """Magnitude and sign of a signed code (thesis section 4.5.2.2).

    fmt: Format of the input. The magnitude has the same fraction bits and one bit less, unsigned.

    The magnitude of the most negative code saturates to the largest code.
    """

    block = "abs_unit"
    section = "4.5.2.2"
    area = "activation"
    latency = 1
    fmt: Fix

    @property
    def mag_width(self) -> int:
        return self.fmt.width - 1

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a code"),
            input_port("in_data", "code", self.fmt),
            output_port("out_valid", "`out_mag` and `out_negative` hold a result"),
            output_port("out_mag", "magnitude", Unsigned(self.mag_width, self.fmt.frac)),
            output_port("out_negative", "the code was below 0"),
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        return (
            Border("the most negative code saturates", "code", self.fmt.low + 1),
            Border("negative", "code", 0),
        )

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        return {"code": inputs[0]}

    def process(self, data: ArrayLike) -> tuple[Codes, NDArray[np.bool_]]:
        """Magnitudes and the flags of negative codes, each the shape of ``data``."""
        codes = self.fmt.check(data, "abs_unit data")
        return np.minimum(np.abs(codes), self.fmt.high), codes < 0
