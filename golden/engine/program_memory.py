"""program_memory: holds the words of a program, and the counter that reads them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.border import State
from golden.common.port import Port, Unsigned, output_port
from golden.engine.program import WORD_WIDTH
from golden.engine.program_words import ProgramWords, Stepped, counters, later
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ProgramMemory(ProgramWords, Stepped):
    """Words of 36 bits, of which a counter reads one in each clock.

    words, notes: See ``ProgramWords``.
    registers: Number of registers behind the memory.
    """

    block = "program_memory"
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        counted = output_port("word", f"the word at the counter, {later(self.latency)}", word)
        return (*self.counter_ports, counted)

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
