"""operand_memory: holds the samples, hidden sums, values of tanh and outputs of one frame."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.formats import WORD


@dataclass(frozen=True)
class OperandMemory(Block):
    """Words of 18 bits; in each clock one is written and one is read.

    registers: Number of registers behind the memory.

    A word that is read in the clock in which it is written has its old value. A word that was never
    written is undefined.
    """

    block = "operand_memory"
    part_of = "engine"
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
