"""program_memory: the words of program and table, and the counter that steps through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.engine.program import WORD_WIDTH
from golden.fixed import Codes
from golden.port import CLOCKED, Port, Unsigned, given, taken


@dataclass(frozen=True)
class ProgramMemory(Block):
    """Words of 36 bits, read twice a clock: by a counter, and by the segment of a hidden sum.

    Parameters
    ----------
    table, words : tuple of int
        The memory holds the table, and behind it the words of the program.
    notes : tuple of str
        What each of them stands for, for the exported file.
    segment_addr_width : int
        Bits of a segment's address.
    registers : int
        Registers behind the memory.
    """

    block = "program_memory"
    area = "engine"
    table: tuple[int, ...]
    words: tuple[int, ...]
    notes: tuple[str, ...]
    segment_addr_width: int
    registers: int = 0

    @property
    def contents(self) -> tuple[int, ...]:
        """Every word, up to a power of two of them."""
        given_words = (*self.table, *self.words)
        return given_words + (0,) * ((1 << self.addr_width) - len(given_words))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What each word stands for; the last holds for all beyond."""
        return (*self.notes, "not used")

    @property
    def addr_width(self) -> int:
        """Bits of the program counter."""
        return max(1, (len(self.table) + len(self.words) - 1).bit_length())

    @property
    def begin(self) -> int:
        """The program's first address."""
        return len(self.table)

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        later, looked_up = (
            f"{clocks} clock{'s' * (clocks > 1)} later"
            for clocks in (self.latency, self.look_up_latency)
        )
        return (
            *CLOCKED,
            taken("start", "the counter steps"),
            taken("run", "so it does; it stands at the program's first word otherwise"),
            taken("finish", "the counter returns to it"),
            taken(
                "segment",
                "which word of the table is read",
                Unsigned(self.segment_addr_width),
                "segment_addr_width",
            ),
            taken("look_up", "it is read; otherwise `table_word` is 0"),
            given("word", f"the counter's word, {later}", word),
            given("table_word", f"that of the table, {looked_up}", word),
        )

    @property
    def latency(self) -> int:
        return 1 + self.registers

    @property
    def look_up_latency(self) -> int:
        """Clocks from a segment to its word."""
        return 1 + 2 * self.registers

    def process(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The word at the counter of each clock, from a clock in which it stands."""
        contents, counter, found = self.contents, self.begin, []
        columns = (np.asarray(c, dtype=bool).tolist() for c in (start, run, finish, reset))
        for starts, runs, ends, resets in zip(*columns, strict=True):
            found.append(contents[counter])
            stands = resets or ends or not (starts or runs)
            counter = self.begin if stands else (counter + 1) % len(contents)
        return np.array(found, dtype=np.int64)

    def look_up(self, segment: ArrayLike, look_up: ArrayLike) -> Codes:
        """The word of the table for each segment, 0 where none is asked for."""
        words = np.array(self.contents, dtype=np.int64)[np.asarray(segment)]
        return np.where(np.asarray(look_up, dtype=bool), words, 0)
