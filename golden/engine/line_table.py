"""A table of straight lines: intercept and slope of each segment of q."""

from __future__ import annotations

from dataclasses import dataclass, replace

from golden.engine.formats import RESULT
from golden.numbers.fixed import Fix


@dataclass(frozen=True)
class LineTable:
    """The words of one or more blocks of segments, each from q = 0 upwards, or from -1 downwards.

    width: w, the number of bits of the distance within a segment.
    intercepts: The function in the middle of each segment, as codes of the block's format; in a
        block for negative q, those of minus the function.
    slopes: Codes of the same format.
    labels: For each block the name of its function, and the format of its results.
    """

    width: int
    intercepts: tuple[int, ...]
    slopes: tuple[int, ...]
    labels: tuple[tuple[str, Fix], ...] = (("tanh", RESULT),)

    @property
    def blocks(self) -> int:
        return len(self.labels)

    @property
    def segments(self) -> int:
        """The number of segments in each block."""
        return len(self.slopes) // self.blocks

    def within(self, reach: int) -> LineTable:
        """The table without segments that no code of q reaches, whose largest magnitude is given.

        Where there are several blocks, each keeps a power of two of segments, and two at least.
        """
        count = min(self.segments, (reach >> self.width) + 1)
        if self.blocks > 1:
            count = max(2, 1 << (count - 1).bit_length())
        kept = [
            place
            for block in range(self.blocks)
            for place in range(block * self.segments, block * self.segments + count)
        ]
        return replace(
            self,
            intercepts=tuple(self.intercepts[place] for place in kept),
            slopes=tuple(self.slopes[place] for place in kept),
        )
