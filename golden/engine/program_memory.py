"""program_memory: holds the words of program and table, and the counter that reads them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.border import State
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.program import WORD_WIDTH
from golden.engine.program_words import ProgramWords, Stepped, counters, later
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ProgramMemory(ProgramWords, Stepped):
    """Words of 36 bits, two read in each clock: at a counter, and at a hidden sum's segment.

    table, words, notes, segment_addr_width: See ``ProgramWords``. An empty table is not looked up,
        and there are no ports for it.
    registers: Number of registers behind the memory.
    """

    block = "program_memory"
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        counted = output_port("word", f"the word at the counter, {later(self.latency)}", word)
        if not self.table:
            return (*self.counter_ports, counted)
        return (
            *self.counter_ports,
            self.segment_port,
            input_port("look_up", "the word at `segment` is read; otherwise `table_word` is 0"),
            counted,
            output_port(
                "table_word", f"the word at `segment`, {later(self.look_up_latency)}", word
            ),
        )

    def process(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The word at the counter in each clock, starting in a clock in which the counter rests."""
        return np.array(self.contents, dtype=np.int64)[self.counter(start, run, finish, reset)]

    @property
    def states(self) -> tuple[State, ...]:
        return (State("counter", range(len(self.contents))),)

    def counter(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The counter in each clock, starting in a clock in which it rests."""
        return counters(self.begin, len(self.contents), start, run, finish, reset)

    def look_up(self, segment: ArrayLike, look_up: ArrayLike) -> Codes:
        """The word of the table for each segment; 0 where ``look_up`` is low."""
        words = np.array(self.contents, dtype=np.int64)[np.asarray(segment)]
        return np.where(np.asarray(look_up, dtype=bool), words, 0)
