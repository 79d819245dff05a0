"""program_ram: the words of program and table, which can be written, and the program's counter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.engine.program import WORD_WIDTH
from golden.fixed import Codes
from golden.port import CLOCKED, Port, Unsigned, given, taken


@dataclass(frozen=True)
class ProgramRam(Block):
    """Words of 36 bits, read by a counter and by the segment of a hidden sum, and written.

    Parameters
    ----------
    addr_width : int
    begin : int
        The program's first address, behind the table.
    segment_addr_width : int
        Bits of a segment's address.
    registers : int
        Registers behind the memory.

    Raises
    ------
    ValueError
        When the memory has no word for a program.

    Notes
    -----
    The write takes the counter's port; in its clock nothing is read. What was never written is
    undefined.
    """

    block = "program_ram"
    area = "engine"
    addr_width: int
    begin: int
    segment_addr_width: int
    registers: int = 0

    def __post_init__(self) -> None:
        words = 1 << self.addr_width
        if not 0 < self.begin < words:
            raise ValueError(
                f"{self.entity}: got {self.begin} words of the table, expected 1 to {words - 1} "
                f"in a memory of {words}"
            )

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
            taken(
                "look_up", "it is read; otherwise, and in the clock of a write, `table_word` is 0"
            ),
            taken("write", "`data` is kept, and nothing is read"),
            taken("write_addr", "where", Unsigned(self.addr_width), "addr_width"),
            taken("data", "a word of an image", word),
            given(
                "word", f"the counter's word, {later}; in the clock of a write that before", word
            ),
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
        self,
        start: ArrayLike,
        run: ArrayLike,
        finish: ArrayLike,
        segment: ArrayLike,
        look_up: ArrayLike,
        write: ArrayLike,
        write_addr: ArrayLike,
        data: ArrayLike,
        reset: ArrayLike,
    ) -> tuple[Codes, Codes]:
        """The counter's word and that of the table for each clock, from one in which it stands.

        -1 is a word that was never written.
        """
        memory = [-1] * (1 << self.addr_width)
        counter = self.begin
        fetched: list[int] = []
        found: list[int] = []
        columns = [
            np.asarray(c).tolist()
            for c in (start, run, finish, segment, look_up, write, write_addr, data, reset)
        ]
        for starts, runs, ends, low, looks, writes, to, word, resets in zip(*columns, strict=True):
            fetched.append(fetched[-1] if writes and fetched else memory[counter])
            found.append(memory[low] if looks and not writes else 0)
            if writes:
                memory[to] = word
            stands = resets or ends or not (starts or runs)
            counter = self.begin if stands else (counter + 1) % len(memory)
        return np.array(fetched, dtype=np.int64), np.array(found, dtype=np.int64)
