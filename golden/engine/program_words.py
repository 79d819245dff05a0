"""What the memories of programs have in common: their contents, and the counter that steps."""

from __future__ import annotations

from dataclasses import dataclass

from golden.block import Block
from golden.port import CLOCKED, Port, Unsigned, taken


@dataclass(frozen=True)
class ProgramWords(Block):
    """Contents that are constants of the entity.

    Parameters
    ----------
    table, words : tuple of int
        The memory holds the table, and behind it the words of the program.
    notes : tuple of str
        What each of them stands for, for the exported file.
    segment_addr_width : int
        Bits of the address of a word of the table.
    """

    area = "engine"
    table: tuple[int, ...]
    words: tuple[int, ...]
    notes: tuple[str, ...]
    segment_addr_width: int

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


class Stepped(Block):
    """A memory through which a counter steps, with registers behind it.

    A subclass has these as fields: the bits of the address of a word of the table, and the
    registers.
    """

    segment_addr_width: int
    registers: int

    @property
    def counter_ports(self) -> tuple[Port, ...]:
        """What steers the counter, and the segment whose word of the table is read."""
        segment = Unsigned(self.segment_addr_width)
        return (
            *CLOCKED,
            taken("start", "the counter steps"),
            taken("run", "so it does; it stands at the program's first word otherwise"),
            taken("finish", "the counter returns to it"),
            taken("segment", "which word of the table is read", segment, "segment_addr_width"),
        )

    @property
    def latency(self) -> int:
        return 1 + self.registers

    @property
    def look_up_latency(self) -> int:
        """Clocks from a segment to its word."""
        return 1 + 2 * self.registers


def stepped(counter: int, begin: int, span: int, moves: bool, stops: bool) -> int:
    """The counter in the next clock.

    Parameters
    ----------
    counter, begin, span : int
        Where it is, where the program begins, and the words of the memory.
    moves, stops : bool
        ``start`` or ``run``, and ``finish`` or reset.
    """
    return (counter + 1) % span if moves and not stops else begin


def later(clocks: int) -> str:
    """So many clocks later, in words."""
    return f"{clocks} clock{'s' * (clocks > 1)} later"
