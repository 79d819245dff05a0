"""program_memory: the words of program and table, and the counter that steps through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.engine.program import WORD_WIDTH
from golden.engine.program_words import ProgramWords, Stepped, later, stepped
from golden.fixed import Codes
from golden.port import Port, Unsigned, given, taken


@dataclass(frozen=True)
class ProgramMemory(ProgramWords, Stepped):
    """Words of 36 bits, read twice a clock: by a counter, and by the segment of a hidden sum.

    Parameters
    ----------
    table, words, notes, segment_addr_width
        See ``ProgramWords``.
    registers : int
        Registers behind the memory.
    """

    block = "program_memory"
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        return (
            *self.counter_ports,
            taken("look_up", "it is read; otherwise `table_word` is 0"),
            given("word", f"the counter's word, {later(self.latency)}", word),
            given("table_word", f"that of the table, {later(self.look_up_latency)}", word),
        )

    def process(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The word at the counter of each clock, from a clock in which it stands."""
        contents, counter, found = self.contents, self.begin, []
        columns = (np.asarray(c, dtype=bool).tolist() for c in (start, run, finish, reset))
        for starts, runs, ends, resets in zip(*columns, strict=True):
            found.append(contents[counter])
            counter = stepped(counter, self.begin, len(contents), starts or runs, resets or ends)
        return np.array(found, dtype=np.int64)

    def look_up(self, segment: ArrayLike, look_up: ArrayLike) -> Codes:
        """The word of the table for each segment, 0 where none is asked for."""
        words = np.array(self.contents, dtype=np.int64)[np.asarray(segment)]
        return np.where(np.asarray(look_up, dtype=bool), words, 0)
