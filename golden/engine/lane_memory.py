"""lane_memory: holds the weights of one lane and, where they are needed, tables of functions."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.formats import WIDTH, WORD
from golden.numbers.fixed import Codes


class Tabled:
    """Something with a table: the intercepts of all segments of its blocks, and then the slopes."""

    table: tuple[int, ...]
    blocks: int

    @property
    def segments(self) -> int:
        """Segments of each block of the table."""
        return len(self.table) // 2 // self.blocks

    @property
    def segment_bits(self) -> int:
        """Bits of the number of a segment."""
        return (self.segments - 1).bit_length() if self.table else 0

    @property
    def block_width(self) -> int:
        """Bits of the number of a block."""
        return (self.blocks - 1).bit_length()

    @property
    def row_width(self) -> int:
        """Bits of the number of an intercept, or of a slope; one at least."""
        return max(1, self.block_width + self.segment_bits)


@dataclass(frozen=True)
class LaneMemory(Tabled, Block):
    """Words of 18 bits: weights at a place, or intercept or slope of the segment of a hidden sum.

    weights: Signed codes.
    table: The intercepts and behind them the slopes of all segments, a power of two of each; empty
        where nothing is looked up.
    segment_width: Bits of a hidden sum within a segment.
    notes: What each word of the table and each weight stands for, as a comment in the exported
        file.
    blocks: Blocks of the table, a power of two. With more than one, the place of a step that looks
        up names the first block of a function, which has the next one for words below 0 if the
        lowest bit of the place is set; see ``golden.engine.function_table``.
    written: Whether the words can be written. Then ``weights`` and ``table`` are what they are
        before, and their numbers are those for which there is room.

    The table lies in the lower half of the memory, and the weights in the upper one, each from its
    beginning. So the address needs no adder, and where no sum lies beyond the last segment no
    comparison either.

    Nothing is read in the clock of a write, because what a block RAM then gives differs between
    devices.
    """

    block = "lane_memory"
    part_of = "engine"
    area = "engine"
    latency = 1
    weights: tuple[int, ...]
    table: tuple[int, ...]
    segment_width: int
    notes: tuple[str, ...] = ()
    blocks: int = 1
    written: bool = False

    @classmethod
    def empty(cls, weights: int, table: int, segment_width: int, blocks: int) -> Self:
        """A memory that can be written, with room for so many weights and words of a table."""
        return cls((0,) * weights, (0,) * table, segment_width, (), blocks, written=True)

    @property
    def last_place(self) -> int:
        """The largest number that names a weight, or the block of a function."""
        return max(len(self.weights) - 1, 2 * self.blocks - 1 if self.blocks > 1 else 0)

    @property
    def place_width(self) -> int:
        """Bits of the address of a weight."""
        return max(1, self.last_place.bit_length())

    @property
    def half_width(self) -> int:
        """Bits of an address within the weights, or within the table."""
        looked_up = 1 + self.row_width if self.table else 0
        return max(self.place_width, looked_up)

    @property
    def addr_width(self) -> int:
        """Bits of an address."""
        return self.half_width + bool(self.table)

    @property
    def contents(self) -> tuple[int, ...]:
        """All words; between the parts there are zeros."""
        mask = (1 << WIDTH) - 1
        weights = [code & mask for code in self.weights]
        parts = [list(self.table), weights] if self.table else [weights]
        half = 1 << self.half_width
        return tuple(word for part in parts for word in part + [0] * (half - len(part)))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What each word stands for; the last text serves all words beyond."""
        texts = list(self.notes[: len(self.table)])
        if self.table:
            texts += ["not used"] * ((1 << self.half_width) - len(texts))
        return (*texts, *self.notes[len(self.table) :], "not used")

    @property
    def ports(self) -> tuple[Port, ...]:
        place = Unsigned(self.place_width, last=self.last_place)
        named = ", or what names a function" if self.blocks > 1 else ""
        looks = (
            input_port("word", "the word that was read, a hidden sum", WORD),
            input_port(
                "kind",
                "1: the intercept of its segment is read, 2: the slope, 0 and 3: the weight",
                Unsigned(2),
            ),
        )
        puts = (
            input_port("write", "`data` is written"),
            input_port("write_addr", "address of the write", Unsigned(self.addr_width)),
            input_port("data", "a weight, or a word of the table", Unsigned(WIDTH)),
        )
        return (
            CLOCK,
            input_port("place", f"address of a weight{named}", place),
            *(looks if self.table else ()),
            *(puts if self.written else ()),
            output_port("coeff", "weight or word of the table, one clock later", Unsigned(WIDTH)),
        )


def block_of(name: ArrayLike, negative: ArrayLike) -> Codes:
    """The block in which a function is looked up that ``name`` names."""
    named = np.asarray(name, dtype=np.int64)
    return np.asarray((named >> 1) | (np.asarray(negative, dtype=np.int64) & named & 1))
