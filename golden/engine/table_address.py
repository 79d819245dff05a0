"""table_address: finds the segment of a table in which a hidden sum lies."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border
from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.formats import HIDDEN
from golden.input_error import InputError
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class TableAddress(Block):
    """The high bits of q, complemented where q is negative, limited to the last segment.

    segment_width: Bits of q within a segment.
    segments: Words of the table, or of each of its blocks, of which it is then a power of two.
    beyond: Whether sums can lie beyond the last segment; the last word serves them too. If False,
        such a sum, which no neuron produces, would read some other word.
    blocks: Blocks of the table. With more than one, ``base`` names the first block of a function,
        which has the next one for negative q if the lowest bit of ``base`` is set; see
        ``golden.engine.function_table``.
    """

    block = "table_address"
    area = "engine"
    segment_width: int
    segments: int
    beyond: bool = True
    blocks: int = 1

    def __post_init__(self) -> None:
        most = 1 << (HIDDEN.width - 1 - self.segment_width)
        if not 1 <= self.segments <= most:
            raise InputError(f"{self.entity}: got segments={self.segments}, expected 1 to {most}")
        whole = self.segments > 1 and not self.segments & (self.segments - 1) and not self.beyond
        if self.blocks > 1 and not whole:
            raise InputError(
                f"{self.entity}: got blocks of {self.segments} segments, expected a power of two, "
                "2 or more, and nothing beyond"
            )

    @property
    def addr_width(self) -> int:
        """Number of bits of an address that reaches the last segment of the last block."""
        return max(1, (self.segments - 1).bit_length()) + self.block_width

    @property
    def block_width(self) -> int:
        """Number of bits of a block's number."""
        return (self.blocks - 1).bit_length()

    @property
    def base_width(self) -> int:
        """Number of bits of ``base``: the number of a block, and whether there are two."""
        return self.block_width + 1

    @property
    def ports(self) -> tuple[Port, ...]:
        # Where no sum lies beyond the last segment, nothing limits the address of an arbitrary
        # code.
        last = self.segments - 1 if self.beyond else (1 << self.addr_width) - 1
        addr = Unsigned(self.addr_width, last=last)
        return (
            CLOCK,
            input_port("q", "a hidden sum", HIDDEN),
            output_port("addr", "segment of q, one clock later", addr, "addr_width"),
            *self.base_ports,
        )

    @property
    def base_ports(self) -> tuple[Port, ...]:
        """What names a function's block; none where there is one block."""
        base = Unsigned(self.base_width)
        text = "twice the number of the function's block; the lowest bit: another block for q < 0"
        return (input_port("base", text, base, "base_width"),) if self.blocks > 1 else ()

    @property
    def latency(self) -> int:
        return 1

    @property
    def borders(self) -> tuple[Border, ...]:
        found = [Border("negative", "q", 0)]
        width = self.segment_width
        for n in range(1, self.segments):
            found.append(Border(f"segment {n} above", "q", n << width))
            found.append(Border(f"segment {n} below", "q", -(n << width)))
        return tuple(found)

    def process(self, q: ArrayLike, base: ArrayLike = 0) -> Codes:
        """The address of the segment of each code."""
        codes = HIDDEN.check(q, f"{self.entity} q")
        complement = np.where(codes < 0, ~codes, codes)
        segments = complement >> self.segment_width
        bits = self.addr_width - self.block_width
        if self.beyond:
            segments = np.minimum(segments, self.segments - 1)
        else:
            segments = segments & ((1 << bits) - 1)
        named = np.asarray(base, dtype=np.int64)
        block = (named >> 1) | ((codes < 0) & named & 1)
        return np.asarray(segments | (block << bits), dtype=np.int64)
