"""The image of a scene: the bytes that make a reloadable engine run it."""

from binascii import crc_hqx
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from golden.engine.formats import WIDTH
from golden.engine.function_table import (
    MOST_WORDS,
    SEGMENT_WIDTH,
    blocks_of,
    in_blocks,
    joined,
    segments_of,
)
from golden.engine.graph import Graph
from golden.engine.line_table import LineTable
from golden.engine.pipeline import Pipeline
from golden.engine.program import WORD_WIDTH, Program, assemble
from golden.engine.tanh_table import tanh_table
from golden.input_error import InputError
from golden.trained.function import TANH, Function

# Bits of the sum in a reloadable engine. They hold 31 products of the largest magnitude, and many
# more products of a trained network, which are smaller. An image whose sums need more bits is
# refused.
ACC_WIDTH = 40
# The same with ReLU. Words of a late layer can have few fraction bits, and then the weights behind
# them have many.
RELU_ACC_WIDTH = 48
# The fields of the header: the lowest bit of each, and the most bits that it can have.
LAST_ADDR = (0, 18)
BEFORE_LAST = (18, 10)
WORD_BYTES = -(-WORD_WIDTH // 8)
CHECK_BYTES = 2
# The value of the check before the bytes that say for which hardware an image is made.
CHECK_PRESET = 0xFFFF


@dataclass(frozen=True)
class Sizes:
    """What the hardware of a reloadable engine depends on: sizes, and what it does with results.

    program_words, operand_words: Words of its memories; each a power of two.
    segment_width: Bits of q within a segment of a table; every image holds whole tables.
    rectifies: Whether it has ReLU.
    even: Of results with ReLU; see ``Neuron``.
    table_blocks: Blocks for the tables of any functions; see ``golden.engine.function_table``.
        Without them there is the table of tanh alone, which is shorter than a block.

    version: Tells images apart whose words are laid out in other ways.
    most_program_bits: The most bits of the address of a word of the program.
    kind: What ``words`` are, as text.
    """

    version: ClassVar[int] = 1
    most_program_bits: ClassVar[int] = LAST_ADDR[1]
    kind: ClassVar[str] = "program words"
    program_words: int = 512
    operand_words: int = 128
    segment_width: int = SEGMENT_WIDTH
    pipeline: Pipeline = field(default_factory=Pipeline)
    rectifies: bool = False
    cut: int = 0
    even: bool = False
    table_blocks: int = 0

    def __post_init__(self) -> None:
        for name, most in (
            ("program_words", self.most_program_bits),
            ("operand_words", BEFORE_LAST[1]),
        ):
            words = getattr(self, name)
            if not 2 <= words <= 1 << most or words & (words - 1):
                raise InputError(
                    f"hardware.{name}: got {words}, expected a power of two, 2 to {1 << most}"
                )
        room = MOST_WORDS // segments_of(self.segment_width)
        if not 0 <= self.table_blocks <= room:
            raise InputError(
                f"hardware.table_blocks: got {self.table_blocks}, expected {room} at most with "
                f"segment_width {self.segment_width}"
            )

    @property
    def program_addr_width(self) -> int:
        return self.program_words.bit_length() - 1

    @property
    def operand_addr_width(self) -> int:
        return self.operand_words.bit_length() - 1

    @property
    def acc_width(self) -> int:
        """Bits of the sum."""
        return RELU_ACC_WIDTH if self.rectifies else ACC_WIDTH

    @property
    def words(self) -> int:
        """Words of the memory that an image is loaded into."""
        return self.program_words

    @property
    def table_words(self) -> int:
        """Words of the tables. The program begins behind them."""
        if self.table_blocks:
            return self.table_blocks * segments_of(self.segment_width)
        return len(tanh_table(self.segment_width).slopes)

    def table_for(self, functions: tuple[Function, ...]) -> LineTable:
        """The table that an image has for some functions, with more blocks if they do not fit."""
        if self.table_blocks:
            return in_blocks(functions, self.segment_width, self.table_blocks)
        return joined(functions, self.segment_width)

    @property
    def check_start(self) -> int:
        """The value of the check before the first byte of an image.

        It covers bytes that are not sent: the version of the format, and what the hardware depends
        on. So an image for other hardware fails its check.
        """
        return crc_hqx(bytes([self.version, *self.hardware]), CHECK_PRESET)

    @property
    def hardware(self) -> list[int]:
        """The bytes that say what the hardware depends on."""
        return [
            self.program_addr_width,
            self.operand_addr_width,
            self.segment_width,
            self.pipeline.memory_registers,
            *([self.cut, self.even] if self.rectifies else []),
            *([self.table_blocks] if self.table_blocks else []),
        ]

    def assembled(self, graph: Graph, table: LineTable) -> Program:
        """The program of a graph with a table for all of the hardware's blocks."""
        return assemble(graph, table, self.pipeline, self.rectifies)

    def laid_out(self, program: Program, graph: Graph) -> tuple[Sequence[int], Sequence[str]]:
        """The words of the image of a graph's program, and what each of them stands for."""
        words = (*program.table, *program.words, *(0 for _ in range(self.more)))
        return words, (*program.notes, *("" for _ in range(self.more)))

    def program_size(self, program: Program) -> int:
        """Words of the program memory that a program takes."""
        return len(program.table) + len(program.words) + self.more

    @property
    def more(self) -> int:
        """Words behind a program that the counter reads until it has returned.

        They have no effect; in an image they are zeros so that they are defined too.
        """
        return 1 + self.pipeline.memory_registers

    def program_of(self, inputs: int, words: Sequence[int], notes: Sequence[str]) -> Program:
        """The program that the words of an image make the hardware execute."""
        return Program(
            inputs,
            self.segment_width,
            tuple(words[: self.table_words]),
            tuple(words[self.table_words :]),
            self.pipeline,
            tuple(notes),
            self.rectifies,
            self.cut,
            self.even,
            max(1, self.table_blocks),
        )

    def text(self) -> str:
        return (
            f"{self.program_words} program words, {self.operand_words} operand words, "
            f"segment_width {self.segment_width}"
            + (f", {self.results}" if self.rectifies else "")
            + (f", {self.table_blocks} blocks of tables" if self.table_blocks else "")
        )

    @property
    def results(self) -> str:
        """What the hardware can do with a result, as text."""
        if not self.rectifies:
            return "no ReLU"
        return f"ReLU of {WIDTH - 1 - self.cut} bits{', halves to even' * self.even}"


@dataclass(frozen=True)
class Image:
    """Contents of the program memory, and how many samples a frame has.

    sizes: Sizes of the hardware for which it is made.
    words: Words of the table and of the program, from address 0 on.
    notes: What each word stands for, where that is known.
    """

    sizes: Sizes
    inputs: int
    words: tuple[int, ...]
    notes: tuple[str, ...] = ()

    @property
    def program(self) -> Program:
        """The program that the hardware executes once the image is loaded."""
        return self.sizes.program_of(self.inputs, self.words, self.notes)

    @property
    def contents(self) -> tuple[int, ...]:
        """The words, and zeros up to the end of the memory."""
        return self.words + (0,) * (self.sizes.words - len(self.words))

    def to_bytes(self) -> bytes:
        """The bytes that are sent: a header, the words from the last to the first, and the check.

        The words come in this order because one counter can then be both the address and the number
        of words that are still to come, and no further length needs to be stored.
        """
        before_last = (self.inputs - 2) % self.sizes.operand_words
        header = ((len(self.words) - 1) << LAST_ADDR[0]) | (before_last << BEFORE_LAST[0])
        sent = b"".join(
            word.to_bytes(WORD_BYTES, "big") for word in (header, *reversed(self.words))
        )
        return sent + crc_hqx(sent, self.sizes.check_start).to_bytes(CHECK_BYTES, "big")


def own_image(graph: Graph, kind: type[Sizes], chosen: Mapping[str, Any]) -> Image:
    """The image of a graph for hardware that is built for it.

    chosen: Arguments of ``kind``, without those that follow from the graph. Without
        ``table_blocks`` there are as many as the functions of the graph take.
    """
    own = 0 if graph.functions == (TANH,) else blocks_of(graph.functions)
    sizes = kind(**{"table_blocks": own, **chosen})
    sizes = replace(sizes, rectifies=graph.rectifies, cut=graph.cut, even=graph.even)
    return image_of(graph, sizes)


def image_of(graph: Graph, sizes: Sizes) -> Image:
    """The image with which hardware of some sizes computes a graph.

    A graph without ReLU fits hardware with ReLU, which then never uses it. A graph fits hardware
    with more blocks of tables than its functions need; those that are left hold zeros.
    """
    table = sizes.table_for(graph.functions)
    program = sizes.assembled(graph, table)
    needed = (
        (
            "program words",
            sizes.program_size(program),
            sizes.program_words,
            " (hardware.program_words)",
        ),
        ("operand words", program.addresses, sizes.operand_words, " (hardware.operand_words)"),
        ("bits of a sum", graph.sum_bits(table), sizes.acc_width, ""),
    )
    faults = [
        f"{count} {what}, there are {most}{key}"
        for what, count, most, key in needed
        if count > most
    ]
    if len(program.table) > sizes.table_words:
        names = ", ".join(function.name for function in graph.functions)
        there = f"are {sizes.table_blocks}" if sizes.table_blocks else "is the table of tanh alone"
        faults.append(f"{blocks_of(graph.functions)} table_blocks for {names}, there {there}")
    wanted = replace(sizes, rectifies=graph.rectifies, cut=graph.cut, even=graph.even)
    if graph.rectifies and wanted != sizes:
        faults.append(f"{wanted.results}, there is {sizes.results}")
    if faults:
        raise InputError(f"the image needs {'; '.join(faults)}")
    words, notes = sizes.laid_out(program, graph)
    return Image(sizes, program.inputs, tuple(words), tuple(notes))
