"""table_address: finds the segment of a table in which a hidden sum lies."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.formats import HIDDEN
from golden.input_error import InputError
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class TableAddress(Block):
    """The high bits of q, complemented where q is negative, limited to the last segment.

    segment_width: Bits of q within a segment.
    segments: Words of the table. The last one serves sums beyond the last segment too.
    """

    block = "table_address"
    part_of = "learning_engine"
    area = "engine"
    latency = 1
    segment_width: int
    segments: int

    def __post_init__(self) -> None:
        most = 1 << (HIDDEN.width - 1 - self.segment_width)
        if not 1 <= self.segments <= most:
            raise InputError(f"{self.entity}: got segments={self.segments}, expected 1 to {most}")

    @property
    def addr_width(self) -> int:
        """Number of bits of an address that reaches the last segment."""
        return max(1, (self.segments - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        addr = Unsigned(self.addr_width, last=self.segments - 1)
        return (
            CLOCK,
            input_port("q", "a hidden sum", HIDDEN),
            output_port("addr", "segment of q, one clock later", addr, "addr_width"),
        )

    def process(self, q: ArrayLike) -> Codes:
        """The address of the segment of each code."""
        codes = HIDDEN.check(q, f"{self.entity} q")
        segments = np.where(codes < 0, ~codes, codes) >> self.segment_width
        return np.asarray(np.minimum(segments, self.segments - 1), dtype=np.int64)
