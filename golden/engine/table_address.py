"""table_address: which segment of tanh's table a hidden sum lies in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.engine.formats import HIDDEN
from golden.fixed import Codes
from golden.port import Port, Unsigned, given, taken


@dataclass(frozen=True)
class TableAddress(Block):
    """The high bits of q, complemented where q is below 0, up to the last segment.

    Parameters
    ----------
    segment_width : int
        Bits of q within a segment.
    segments : int
        Words of the table; the last holds for every segment beyond.

    Raises
    ------
    ValueError
        When q has fewer segments.
    """

    block = "table_address"
    area = "engine"
    segment_width: int
    segments: int

    def __post_init__(self) -> None:
        most = 1 << (HIDDEN.width - 1 - self.segment_width)
        if not 1 <= self.segments <= most:
            raise ValueError(f"{self.entity}: got segments={self.segments}, expected 1 to {most}")

    @property
    def addr_width(self) -> int:
        """Bits of the address of the last segment."""
        return max(1, (self.segments - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            taken("q", "a hidden sum", HIDDEN),
            given(
                "addr", "its segment, in the same clock", Unsigned(self.addr_width), "addr_width"
            ),
        )

    @property
    def latency(self) -> int:
        return 0

    def process(self, q: ArrayLike) -> Codes:
        """The segment of each code.

        Raises
        ------
        ValueError
            For a code outside the format of q.
        """
        codes = HIDDEN.check(q, f"{self.entity} q")
        complement = np.where(codes < 0, ~codes, codes)
        segments = np.minimum(complement >> self.segment_width, self.segments - 1)
        return np.asarray(segments, dtype=np.int64)
