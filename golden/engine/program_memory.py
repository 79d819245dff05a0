"""program_memory: holds the words of a program, and the counter that reads them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import State
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.engine.formats import WORD_WIDTH
from golden.numbers.fixed import Codes

# The ports that control the counter.
COUNTER_PORTS = (
    *CLOCKED,
    input_port("start", "the counter steps"),
    input_port("run", "the counter steps; otherwise it rests at the first word of the program"),
    input_port("finish", "the counter returns to the first word of the program"),
)


@dataclass(frozen=True)
class ProgramMemory(Block):
    """Words of 36 bits, of which a counter reads one in each clock.

    words: The words of the program.
    notes: What each word stands for, as a comment in the exported file.
    registers: Number of registers behind the memory.
    """

    block = "program_memory"
    area = "engine"
    words: tuple[int, ...]
    notes: tuple[str, ...]
    registers: int = 0

    @property
    def contents(self) -> tuple[int, ...]:
        """All words, filled with zeros up to a power of two."""
        return self.words + (0,) * ((1 << self.addr_width) - len(self.words))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What each word stands for; the last text serves all words beyond."""
        return (*self.notes, "not used")

    @property
    def addr_width(self) -> int:
        """Bits of the program counter."""
        return max(1, (len(self.words) - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        counted = output_port("word", f"the word at the counter, {later(self.latency)}", word)
        return (*COUNTER_PORTS, counted)

    @property
    def latency(self) -> int:
        return 1 + self.registers

    @property
    def states(self) -> tuple[State, ...]:
        return (State("counter", range(len(self.contents))),)

    def process(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The word at the counter in each clock, starting in a clock in which the counter rests."""
        return np.array(self.contents, dtype=np.int64)[self.counter(start, run, finish, reset)]

    def counter(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The counter in each clock, starting in a clock in which it rests."""
        return counters(len(self.contents), start, run, finish, reset)


def counters(
    words: int, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
) -> Codes:
    """The counter in each clock, starting in a clock in which it rests at 0.

    After the last word of the memory follows the first.
    """
    counter, found = 0, []
    columns = (np.asarray(c, dtype=bool).tolist() for c in (start, run, finish, reset))
    for starts, runs, ends, resets in zip(*columns, strict=True):
        found.append(counter)
        counter = (counter + 1) % words if (starts or runs) and not (resets or ends) else 0
    return np.array(found, dtype=np.int64)


def later(clocks: int) -> str:
    """A text such as "2 clocks later"."""
    return f"{clocks} clock{'s' * (clocks > 1)} later"
