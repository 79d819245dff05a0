"""The parts that all memories of programs share: their contents, and the counter."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, input_port
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ProgramWords(Block):
    """A memory whose contents are constants of the entity.

    words: The words of the program.
    notes: What each word stands for, as a comment in the exported file.
    table: Words that stand before the program, if there are any.
    """

    area = "engine"
    words: tuple[int, ...]
    notes: tuple[str, ...]
    table: tuple[int, ...] = ()

    @property
    def contents(self) -> tuple[int, ...]:
        """All words, filled with zeros up to a power of two."""
        all_words = (*self.table, *self.words)
        return all_words + (0,) * ((1 << self.addr_width) - len(all_words))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What each word stands for; the last text serves all words beyond."""
        return (*self.notes, "not used")

    @property
    def addr_width(self) -> int:
        """Bits of the program counter."""
        return max(1, (len(self.table) + len(self.words) - 1).bit_length())

    @property
    def begin(self) -> int:
        """The first address of the program."""
        return len(self.table)


class Stepped(Block):
    """A memory through which a counter steps. A subclass has the number of registers behind it."""

    registers: int

    @property
    def counter_ports(self) -> tuple[Port, ...]:
        """The ports that control the counter."""
        return (
            *CLOCKED,
            input_port("start", "the counter steps"),
            input_port(
                "run", "the counter steps; otherwise it rests at the first word of the program"
            ),
            input_port("finish", "the counter returns to the first word of the program"),
        )

    @property
    def latency(self) -> int:
        return 1 + self.registers


def counters(
    begin: int,
    words: int,
    start: ArrayLike,
    run: ArrayLike,
    finish: ArrayLike,
    reset: ArrayLike,
) -> Codes:
    """The counter in each clock, starting in a clock in which it rests at ``begin``.

    After the last word of the memory follows the first.
    """
    counter, found = begin, []
    columns = (np.asarray(c, dtype=bool).tolist() for c in (start, run, finish, reset))
    for starts, runs, ends, resets in zip(*columns, strict=True):
        found.append(counter)
        counter = (counter + 1) % words if (starts or runs) and not (resets or ends) else begin
    return np.array(found, dtype=np.int64)


def later(clocks: int) -> str:
    """A text such as "2 clocks later"."""
    return f"{clocks} clock{'s' * (clocks > 1)} later"
