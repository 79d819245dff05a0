"""Memories for the words of a program, fixed or writable, with the counter that reads them."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.engine.formats import WORD_WIDTH

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
    part_of = "engine"
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


@dataclass(frozen=True)
class ProgramRam(Block):
    """Words of 36 bits that can be written, and of which a counter reads one in each clock.

    registers: Number of registers behind the memory.

    A write uses the counter's port, so nothing is read in its clock. A word that was not written
    since the last reset is undefined; this does no harm, since an image is loaded after each reset.
    """

    block = "program_ram"
    part_of = "engine"
    area = "engine"
    addr_width: int
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(WORD_WIDTH)
        return (
            *COUNTER_PORTS,
            input_port("write", "`data` is written, and nothing is read"),
            input_port("write_addr", "address of the write", Unsigned(self.addr_width)),
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


def later(clocks: int) -> str:
    """A text such as "2 clocks later"."""
    return f"{clocks} clock{'s' * (clocks > 1)} later"
