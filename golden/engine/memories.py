"""Memories of an engine: of operands, of a program, and of the weights and the table of a lane."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, CLOCKED, Port, Unsigned, input_port, output_port
from golden.engine.formats import WIDTH, WORD, WORD_WIDTH
from golden.numbers.fixed import Codes

# The ports that control the counter.
COUNTER_PORTS = (
    *CLOCKED,
    input_port("start", "the counter steps"),
    input_port("run", "the counter steps; otherwise it rests at the first word of the program"),
    input_port("finish", "the counter returns to the first word of the program"),
)


def later(clocks: int) -> str:
    """A text such as "2 clocks later"."""
    return f"{clocks} clock{'s' * (clocks > 1)} later"


class Memory(Block):
    """A memory whose word comes a clock after its address, and one later for each register.

    registers: Number of registers behind the memory.
    """

    part_of = "engine"
    area = "engine"
    registers: int

    @property
    def latency(self) -> int:
        return 1 + self.registers


@dataclass(frozen=True)
class OperandMemory(Memory):
    """Words of 18 bits; in each clock one is written and one is read.

    A word that is read in the clock in which it is written has its old value. A word that was never
    written is undefined.
    """

    block = "operand_memory"
    addr_width: int
    registers: int = 0

    @property
    def ports(self) -> tuple[Port, ...]:
        addr = Unsigned(self.addr_width)
        return (
            CLOCK,
            input_port("write", "`data` is written"),
            input_port("write_addr", "address of the write", addr),
            input_port("data", "a sample or a result, whose format is that of its neuron", WORD),
            input_port("read_addr", "address of the read", addr),
            output_port("word", f"the word at `read_addr`, {later(self.latency)}", WORD),
        )


@dataclass(frozen=True)
class ProgramMemory(Memory):
    """Words of 36 bits, of which a counter reads one in each clock.

    words: The words of the program.
    notes: What each word stands for, as a comment in the exported file.
    """

    block = "program_memory"
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


@dataclass(frozen=True)
class ProgramRam(Memory):
    """Words of 36 bits that can be written, and of which a counter reads one in each clock.

    A write uses the counter's port, so nothing is read in its clock. A word that was not written
    since the last reset is undefined; this does no harm, since an image is loaded after each reset.
    """

    block = "program_ram"
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


class Tabled:
    """Something with a table: the intercepts of all segments of its blocks, and then the slopes."""

    table: tuple[int, ...]
    blocks: int

    @property
    def segments(self) -> int:
        """Segments of each block of the table."""
        return len(self.table) // 2 // self.blocks

    @property
    def segment_bits(self) -> int:
        """Bits of the number of a segment."""
        return (self.segments - 1).bit_length() if self.table else 0

    @property
    def block_width(self) -> int:
        """Bits of the number of a block."""
        return (self.blocks - 1).bit_length()

    @property
    def row_width(self) -> int:
        """Bits of the number of an intercept, or of a slope; one at least."""
        return max(1, self.block_width + self.segment_bits)


@dataclass(frozen=True)
class LaneMemory(Tabled, Block):
    """Words of 18 bits: weights at a place, or intercept or slope of the segment of a hidden sum.

    weights: Signed codes.
    table: The intercepts and behind them the slopes of all segments, a power of two of each; empty
        where nothing is looked up.
    segment_width: Bits of a hidden sum within a segment.
    notes: What each word of the table and each weight stands for, as a comment in the exported
        file.
    blocks: Blocks of the table, a power of two. With more than one, the place of a step that looks
        up names the first block of a function, which has the next one for words below 0 if the
        lowest bit of the place is set; see ``golden.engine.function_table``.
    written: Whether the words can be written. Then ``weights`` and ``table`` are what they are
        before, and their numbers are those for which there is room.

    The table lies in the lower half of the memory, and the weights in the upper one, each from its
    beginning. So the address needs no adder, and where no sum lies beyond the last segment no
    comparison either.

    Nothing is read in the clock of a write, because what a block RAM then gives differs between
    devices.
    """

    block = "lane_memory"
    part_of = "engine"
    area = "engine"
    latency = 1
    weights: tuple[int, ...]
    table: tuple[int, ...]
    segment_width: int
    notes: tuple[str, ...] = ()
    blocks: int = 1
    written: bool = False

    @property
    def last_place(self) -> int:
        """The largest number that names a weight, or the block of a function."""
        return max(len(self.weights) - 1, 2 * self.blocks - 1 if self.blocks > 1 else 0)

    @property
    def place_width(self) -> int:
        """Bits of the address of a weight."""
        return max(1, self.last_place.bit_length())

    @property
    def half_width(self) -> int:
        """Bits of an address within the weights, or within the table."""
        looked_up = 1 + self.row_width if self.table else 0
        return max(self.place_width, looked_up)

    @property
    def addr_width(self) -> int:
        """Bits of an address."""
        return self.half_width + bool(self.table)

    @property
    def contents(self) -> tuple[int, ...]:
        """All words; between the parts there are zeros."""
        mask = (1 << WIDTH) - 1
        weights = [code & mask for code in self.weights]
        parts = [list(self.table), weights] if self.table else [weights]
        half = 1 << self.half_width
        return tuple(word for part in parts for word in part + [0] * (half - len(part)))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What each word stands for; the last text serves all words beyond."""
        texts = list(self.notes[: len(self.table)])
        if self.table:
            texts += ["not used"] * ((1 << self.half_width) - len(texts))
        return (*texts, *self.notes[len(self.table) :], "not used")

    @property
    def ports(self) -> tuple[Port, ...]:
        place = Unsigned(self.place_width, last=self.last_place)
        named = ", or what names a function" if self.blocks > 1 else ""
        looks = (
            input_port("word", "the word that was read, a hidden sum", WORD),
            input_port(
                "kind",
                "1: the intercept of its segment is read, 2: the slope, 0 and 3: the weight",
                Unsigned(2),
            ),
        )
        puts = (
            input_port("write", "`data` is written"),
            input_port("write_addr", "address of the write", Unsigned(self.addr_width)),
            input_port("data", "a weight, or a word of the table", Unsigned(WIDTH)),
        )
        return (
            CLOCK,
            input_port("place", f"address of a weight{named}", place),
            *(looks if self.table else ()),
            *(puts if self.written else ()),
            output_port("coeff", "weight or word of the table, one clock later", Unsigned(WIDTH)),
        )


def block_of(name: ArrayLike, negative: ArrayLike) -> Codes:
    """The block in which a function is looked up that ``name`` names."""
    named = np.asarray(name, dtype=np.int64)
    return np.asarray((named >> 1) | (np.asarray(negative, dtype=np.int64) & named & 1))
