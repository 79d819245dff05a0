"""lane_memory: holds the weights of one lane and, where it is needed, the table of tanh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.border import Border
from golden.engine.formats import HIDDEN, WIDTH
from golden.engine.graph import Kind
from golden.engine.operand_memory import WORD
from golden.fixed import Codes
from golden.port import CLOCK, Port, Unsigned, input_port, output_port


@dataclass(frozen=True)
class LaneMemory(Block):
    """Words of 18 bits: weights at a place, or intercept or slope of the segment of a hidden sum.

    Parameters
    ----------
    weights : tuple of int
        Signed codes.
    table : tuple of int
        The intercepts and behind them the slopes of all segments, a power of two of each; empty
        where nothing is looked up.
    segment_width : int
        Bits of a hidden sum within a segment.
    notes : tuple of str
        What each word of the table and each weight stands for, as a comment in the exported file.

    Notes
    -----
    The table lies in the lower half of the memory, and the weights in the upper one, each from its
    beginning. So the address needs no adder, and where no sum lies beyond the last segment no
    comparison either.
    """

    block = "lane_memory"
    area = "engine"
    weights: tuple[int, ...]
    table: tuple[int, ...]
    segment_width: int
    notes: tuple[str, ...] = ()

    @property
    def place_width(self) -> int:
        """Bits of the address of a weight."""
        return max(1, (len(self.weights) - 1).bit_length())

    @property
    def segment_bits(self) -> int:
        """Bits of the number of a segment."""
        return (len(self.table) // 2 - 1).bit_length() if self.table else 0

    @property
    def half_width(self) -> int:
        """Bits of an address within the weights, or within the table."""
        return max(self.place_width, self.segment_bits + 1) if self.table else self.place_width

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
        place = Unsigned(self.place_width, last=len(self.weights) - 1)
        looks = (
            input_port("word", "the word that was read, a hidden sum", WORD),
            input_port(
                "kind",
                "1: the intercept of its segment is read, 2: the slope, 0 and 3: the weight",
                Unsigned(2),
            ),
        )
        return (
            CLOCK,
            input_port("place", "address of a weight", place, "place_width"),
            *(looks if self.table else ()),
            output_port("coeff", "weight or word of the table, one clock later", Unsigned(WIDTH)),
        )

    @property
    def latency(self) -> int:
        return 1

    @property
    def borders(self) -> tuple[Border, ...]:
        if not self.table:
            return ()
        found = [Border("negative", "word", 0)]
        for n in range(1, len(self.table) // 2):
            found.append(Border(f"segment {n} above", "word", n << self.segment_width))
            found.append(Border(f"segment {n} below", "word", -(n << self.segment_width)))
        return tuple(found)

    def address(self, place: ArrayLike, word: ArrayLike = 0, kind: ArrayLike = 0) -> Codes:
        """The address that is read."""
        places = np.asarray(place, dtype=np.int64)
        if not self.table:
            return places
        words, kinds = HIDDEN.check(word, f"{self.entity} word"), np.asarray(kind)
        segment = np.where(words < 0, ~words, words) >> self.segment_width
        segment &= len(self.table) // 2 - 1
        slope = np.where(kinds == Kind.DISTANCE, len(self.table) // 2, 0)
        looks = (kinds == Kind.INTERCEPT) | (kinds == Kind.DISTANCE)
        return np.where(looks, slope + segment, places + (1 << self.half_width))

    def process(self, place: ArrayLike, word: ArrayLike = 0, kind: ArrayLike = 0) -> Codes:
        """The word that is read for each place, word and kind."""
        return np.array(self.contents, dtype=np.int64)[self.address(place, word, kind)]
