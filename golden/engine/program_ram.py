"""program_ram: the words of program and table, which can be written, and the program's counter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.border import State
from golden.engine.program import WORD_WIDTH
from golden.engine.program_words import Stepped, counters, later
from golden.fixed import Codes
from golden.input_error import InputError
from golden.port import Port, Unsigned, given, taken


@dataclass(frozen=True)
class ProgramRam(Stepped):
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
    InputError
        When the memory has no word for a program.

    Notes
    -----
    The write takes the counter's port; in its clock nothing is read. What was not written since the
    last reset is undefined: an image is loaded after each.
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
            raise InputError(
                f"{self.entity}: got {self.begin} words of the table, expected 1 to {words - 1} "
                f"in a memory of {words}"
            )

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        return (
            *self.counter_ports,
            taken(
                "look_up",
                "the word at `segment` is read; otherwise, and in a write, `table_word` is 0",
            ),
            taken("write", "`data` is written, and nothing is read"),
            taken("write_addr", "address of the write", Unsigned(self.addr_width), "addr_width"),
            taken("data", "a word of an image", word),
            given(
                "word",
                f"the word at the counter, {later(self.latency)}; unchanged by a write",
                word,
            ),
            given("table_word", f"the word at `segment`, {later(self.look_up_latency)}", word),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("counter", range(1 << self.addr_width)),)

    def counter(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The counter of each clock, from a clock in which it stands."""
        return counters(self.begin, 1 << self.addr_width, start, run, finish, reset)

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

        -1 is a word that is undefined: not written since the last reset, or not read since.
        """
        empty = [-1] * (1 << self.addr_width)
        memory = list(empty)
        fetched: list[int] = []
        found: list[int] = []
        counter = self.counter(start, run, finish, reset)
        columns = [
            np.asarray(c).tolist()
            for c in (counter, segment, look_up, write, write_addr, data, reset)
        ]
        for here, low, looks, writes, to, word, resets in zip(*columns, strict=True):
            if resets:
                memory = list(empty)
                fetched.append(-1)
                found.append(-1)
                continue
            fetched.append(fetched[-1] if writes and fetched else memory[here])
            found.append(memory[low] if looks and not writes else 0)
            if writes:
                memory[to] = word
        return np.array(fetched, dtype=np.int64), np.array(found, dtype=np.int64)
