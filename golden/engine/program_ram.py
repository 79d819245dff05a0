"""program_ram: a writable memory for the words of a program, with its counter."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import State
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.formats import WORD_WIDTH
from golden.engine.program_memory import COUNTER_PORTS, counters, later
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ProgramRam(Block):
    """Words of 36 bits that can be written, and of which a counter reads one in each clock.

    registers: Number of registers behind the memory.

    A write uses the counter's port, so nothing is read in its clock. A word that was not written
    since the last reset is undefined; this does no harm, since an image is loaded after each reset.
    """

    block = "program_ram"
    area = "engine"
    addr_width: int
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        return (
            *COUNTER_PORTS,
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
        )

    @property
    def latency(self) -> int:
        return 1 + self.registers

    @property
    def states(self) -> tuple[State, ...]:
        return (State("counter", range(1 << self.addr_width)),)

    def counter(
        self, start: ArrayLike, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> Codes:
        """The counter in each clock, starting in a clock in which it rests."""
        return counters(1 << self.addr_width, start, run, finish, reset)

    def process(
        self,
        start: ArrayLike,
        run: ArrayLike,
        finish: ArrayLike,
        write: ArrayLike,
        write_addr: ArrayLike,
        data: ArrayLike,
        reset: ArrayLike,
    ) -> Codes:
        """The word of the counter in each clock, from a clock of rest on.

        An undefined word is -1: it was not written, or nothing was read, since the last reset.
        """
        empty = [-1] * (1 << self.addr_width)
        memory = list(empty)
        fetched: list[int] = []
        counter = self.counter(start, run, finish, reset)
        columns = [np.asarray(c).tolist() for c in (counter, write, write_addr, data, reset)]
        for here, writes, to, word, resets in zip(*columns, strict=True):
            if resets:
                memory = list(empty)
                fetched.append(-1)
                continue
            fetched.append(fetched[-1] if writes and fetched else memory[here])
            if writes:
                memory[to] = word
        return np.array(fetched, dtype=np.int64)
