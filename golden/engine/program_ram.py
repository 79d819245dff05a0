"""program_ram: a writable memory for the words of program and table, with its counter."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.border import State
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.program import WORD_WIDTH
from golden.engine.program_words import Stepped, counters, later
from golden.input_error import InputError
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ProgramRam(Stepped):
    """Words of 36 bits that can be written, and are read by a counter and by a segment.

    begin: First address of the program, which stands behind the table.
    segment_addr_width: Bits of a segment's address; 0 for no table.
    registers: Number of registers behind the memory.

    A write uses the counter's port, so nothing is read in its clock. A word that was not written
    since the last reset is undefined; this does no harm, since an image is loaded after each reset.
    """

    block = "program_ram"
    area = "engine"
    addr_width: int
    begin: int
    segment_addr_width: int
    registers: int = 0

    def __post_init__(self) -> None:
        words = 1 << self.addr_width
        least = int(self.segment_addr_width > 0)
        if not least <= self.begin < words:
            raise InputError(
                f"{self.entity}: got {self.begin} words of the table, expected {least} to "
                f"{words - 1} in a memory of {words}"
            )

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        looked = (
            self.segment_port,
            input_port(
                "look_up",
                "the word at `segment` is read; otherwise, and in a write, `table_word` is 0",
            ),
        )
        found = output_port(
            "table_word", f"the word at `segment`, {later(self.look_up_latency)}", word
        )
        return (
            *self.counter_ports,
            *(looked if self.segment_addr_width else ()),
            input_port("write", "`data` is written, and nothing is read"),
            input_port(
                "write_addr", "address of the write", Unsigned(self.addr_width), "addr_width"
            ),
            input_port("data", "a word of an image", word),
            output_port(
                "word",
                f"the word at the counter, {later(self.latency)}; unchanged by a write",
                word,
            ),
            *([found] if self.segment_addr_width else ()),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("counter", range(1 << self.addr_width)),)

    def counter(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The counter in each clock, starting in a clock in which it rests."""
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
        """The word of the counter and that of the table in each clock, from a clock of rest on.

        An undefined word is -1: it was not written, or nothing was read, since the last reset.
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
