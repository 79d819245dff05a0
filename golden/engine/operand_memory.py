"""operand_memory: holds the samples, hidden sums, values of tanh and outputs of one frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.formats import WIDTH
from golden.numbers.fixed import Codes, Fix

WORD = Fix(WIDTH, 0)


@dataclass(frozen=True)
class OperandMemory(Block):
    """Words of 18 bits; in each clock one is written and one is read.

    registers: Number of registers behind the memory.

    A word that is read in the clock in which it is written has its old value. A word that was never
    written is undefined.
    """

    block = "operand_memory"
    area = "engine"
    addr_width: int
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        addr = Unsigned(self.addr_width)
        return (
            CLOCK,
            input_port("write", "`data` is written"),
            input_port("write_addr", "address of the write", addr, "addr_width"),
            input_port("data", "a sample or a result, whose format is that of its neuron", WORD),
            input_port("read_addr", "address of the read", addr, "addr_width"),
            output_port(
                "word",
                f"the word at `read_addr`, {self.latency} clock{'s' * (self.latency > 1)} later",
                WORD,
            ),
        )

    @property
    def latency(self) -> int:
        return 1 + self.registers

    def process(
        self, write: ArrayLike, write_addr: ArrayLike, data: ArrayLike, read_addr: ArrayLike
    ) -> Codes:
        """The word that is read in each clock; words that were never written are 0 here."""
        memory = np.zeros(1 << self.addr_width, dtype=np.int64)
        columns = [np.asarray(c).tolist() for c in (write, write_addr, data, read_addr)]
        found = []
        for flag, to, word, source in zip(*columns, strict=True):
            found.append(memory[source])
            if flag:
                memory[to] = word
        return np.array(found, dtype=np.int64)
