"""What the accumulators of a lane and of an engine that learns share."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.engine.formats import PRODUCT_WIDTH
from golden.input_error import InputError

_MOST_WIDTH = 48


@dataclass(frozen=True)
class Accumulator(Block):
    """A block that holds a sum of ``acc_width`` bits.

    acc_width: Bits of the sum, 36 or more. The sums of a program that was assembled for this width
        always fit in it.
    """

    area = "engine"
    acc_width: int

    def __post_init__(self) -> None:
        if not PRODUCT_WIDTH <= self.acc_width <= _MOST_WIDTH:
            raise InputError(
                f"{self.entity}: got acc_width={self.acc_width}, expected {PRODUCT_WIDTH} to "
                f"{_MOST_WIDTH}"
            )
