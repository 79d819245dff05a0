"""The image of a scene: the bytes that make a reloadable engine run it.

Its words go to several memories. The tables come first, each word of them to every lane. Behind
them is a row for each word of the program: that word, the weights of lanes 0 and 1 at the place of
the row's number, one in each half of a word, those of lanes 2 and 3, and so on. A row has a power
of two of words, so the low bits of an address say where a word goes, and the high bits to which
address. What is left of a row is 0, and what is left of the memories is not sent.

A program has no more places of weights than words, because each place but the first, whose weights
are 0, is that of a step.
"""

from binascii import crc_hqx
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, zip_longest
from typing import Any

from golden.engine.formats import WIDTH, WORD_WIDTH, signed_code
from golden.engine.function_table import (
    MOST_WORDS,
    SEGMENT_WIDTH,
    blocks_of,
    in_blocks,
    joined,
    segments_of,
)
from golden.engine.graph import Graph
from golden.engine.lane_groups import LaneGraph
from golden.engine.lane_program import LaneProgram, Layout, assemble_lanes
from golden.engine.pipeline import Pipeline
from golden.input_error import InputError
from golden.trained.function import TANH

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
# Tells images apart whose words are laid out in other ways.
VERSION = 2
_MASK = (1 << WIDTH) - 1


def most_program_bits(lanes: int) -> int:
    """The most bits of the address of a word of the program.

    A place has as many, and a header names all words of an image.
    """
    columns = 1 << (-(-lanes // 2)).bit_length()
    return min(Layout.of(lanes)["place"][1], LAST_ADDR[1] - columns.bit_length())


@dataclass(frozen=True)
class Sizes:
    """What the hardware of a reloadable engine depends on: sizes, and what it does with results.

    program_words: Words of the program memory, and of each half of the memory of a lane.
    operand_words: Words of the memory of operands. Both are a power of two.
    segment_width: Bits of q within a segment of a table; every image holds whole tables.
    rectifies: Whether it has ReLU.
    even: Of results with ReLU; see ``Neuron``.
    table_blocks: Blocks for the tables of any functions; see ``golden.engine.function_table``.
        Without them there is the table of tanh alone, which is shorter than a block.
    lanes: An image for fewer lanes leaves the others without work.
    """

    program_words: int = 512
    operand_words: int = 128
    segment_width: int = SEGMENT_WIDTH
    pipeline: Pipeline = field(default_factory=Pipeline)
    rectifies: bool = False
    cut: int = 0
    even: bool = False
    table_blocks: int = 0
    lanes: int = 1

    def __post_init__(self) -> None:
        for name, most in (
            ("program_words", most_program_bits(self.lanes)),
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
        if self.table_words > self.program_words:
            raise InputError(
                f"hardware.program_words: got {self.program_words}, expected {self.table_words} or "
                f"more, which the tables of each lane take with segment_width {self.segment_width}"
                + (f" and table_blocks {self.table_blocks}" if self.table_blocks else "")
            )

    @property
    def program_addr_width(self) -> int:
        return self.program_words.bit_length() - 1

    @property
    def operand_addr_width(self) -> int:
        return self.operand_words.bit_length() - 1

    @property
    def acc_width(self) -> int:
        return RELU_ACC_WIDTH if self.rectifies else ACC_WIDTH

    @property
    def columns(self) -> int:
        """Words of a row: one of the program, and one for the weights of two lanes each."""
        return 1 << (-(-self.lanes // 2)).bit_length()

    @property
    def words(self) -> int:
        return self.table_words + self.columns * self.program_words

    @property
    def blocks(self) -> int:
        """Blocks of the tables, a power of two."""
        return 1 << (max(1, self.table_blocks) - 1).bit_length()

    @property
    def table_words(self) -> int:
        """Words of the tables: all intercepts, and behind them all slopes."""
        return 2 * self.blocks * segments_of(self.segment_width)

    @property
    def check_start(self) -> int:
        """The value of the check before the first byte of an image.

        It covers bytes that are not sent: the version of the layout, and what the hardware depends
        on. So an image for other hardware fails its check.
        """
        return crc_hqx(bytes([VERSION, *self.hardware]), CHECK_PRESET)

    @property
    def hardware(self) -> list[int]:
        """The bytes that say what the hardware depends on."""
        return [
            self.lanes,
            self.program_addr_width,
            self.operand_addr_width,
            self.segment_width,
            self.pipeline.memory_registers,
            *([self.cut, self.even] if self.rectifies else []),
            *([self.table_blocks] if self.table_blocks else []),
        ]

    @property
    def more(self) -> int:
        """Words behind a program that the counter reads until it has returned.

        They have no effect; in an image they are zeros so that they are defined too.
        """
        return 1 + self.pipeline.memory_registers

    def laid_out(self, program: LaneProgram, graph: Graph) -> tuple[Sequence[int], Sequence[str]]:
        """The words of the image of a graph's program, and what each of them stands for."""
        table, more = len(program.table), range(self.more)
        texts = [program.weight_notes(graph, lane) for lane in range(self.lanes)]
        columns = [(*program.words, *(0 for _ in more))]
        notes = [(*program.notes, *("" for _ in more))]
        for first in range(0, self.lanes, 2):
            pairs = [row[first : first + 2] for row in program.weights]
            meant = zip(*(text[table:] for text in texts[first : first + 2]), strict=True)
            columns.append(tuple(_halves(pair) for pair in pairs))
            notes.append(tuple(" and ".join(dict.fromkeys(pair)) for pair in meant))
        left = self.columns - len(columns)
        words = zip_longest(*columns, *[()] * left, fillvalue=0)
        meanings = zip_longest(*notes, *[()] * left, fillvalue="")
        return (
            (*(word << WIDTH | word for word in program.table), *chain(*words)),
            (*texts[0][:table], *chain(*meanings)),
        )

    def program_of(self, inputs: int, words: Sequence[int], notes: Sequence[str]) -> LaneProgram:
        """The program that the words of an image make the hardware execute."""
        table = self.table_words
        code, *pairs = (tuple(words[table + n :: self.columns]) for n in range(self.columns))
        halves = [
            [signed_code(word >> low & _MASK) for word in pair]
            for pair in pairs
            for low in (0, WIDTH)
        ]
        return LaneProgram(
            inputs,
            self.segment_width,
            tuple(word & _MASK for word in words[:table]),
            code,
            self.pipeline,
            tuple(notes[table :: self.columns]),
            self.rectifies,
            self.cut,
            self.even,
            self.blocks,
            # An image does not say which neurons its steps belong to.
            layout=Layout.of(self.lanes),
            shared=LaneGraph(
                self.lanes,
                Graph(inputs, ()),
                (),
                tuple(zip_longest(*halves[: self.lanes], fillvalue=0)),
            ),
        )

    def text(self) -> str:
        return (
            f"lanes {self.lanes}, {self.program_words} program words, {self.operand_words} operand "
            f"words, segment_width {self.segment_width}"
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
    def program(self) -> LaneProgram:
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


def own_image(graph: Graph, chosen: Mapping[str, Any]) -> Image:
    """The image of a graph for hardware that is built for it.

    chosen: Arguments of ``Sizes``, without those that follow from the graph. Without
        ``table_blocks`` there are as many as the functions of the graph take, and without
        ``program_words`` there is room for these.
    """
    own = 0 if graph.functions == (TANH,) else blocks_of(graph.functions)
    given = {"table_blocks": own, **chosen}
    if "program_words" not in given:
        # As many as the tables take, if these take more than usual.
        room = Sizes(
            **given, program_words=1 << most_program_bits(given.get("lanes", 1))
        ).table_words
        given["program_words"] = max(Sizes.program_words, room)
    sizes = Sizes(**given)
    sizes = replace(sizes, rectifies=graph.rectifies, cut=graph.cut, even=graph.even)
    return image_of(graph, sizes)


def image_of(graph: Graph, sizes: Sizes) -> Image:
    """The image with which hardware of some sizes computes a graph.

    A graph without ReLU fits hardware with ReLU, which then never uses it. A graph fits hardware
    with more blocks of tables than its functions need; those that are left hold zeros.
    """
    width, blocks = sizes.segment_width, sizes.table_blocks
    # There are more blocks than these if the functions do not fit.
    table = in_blocks(graph.functions, width, blocks) if blocks else joined(graph.functions, width)
    program = assemble_lanes(graph, table, sizes.lanes, sizes.pipeline, every=True)
    needed = (
        (
            "program words",
            len(program.words) + sizes.more,
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


def _halves(weights: Sequence[int]) -> int:
    """The word in whose halves the weights of two lanes, or of one, stand."""
    return sum((weight & _MASK) << n * WIDTH for n, weight in enumerate(weights))
