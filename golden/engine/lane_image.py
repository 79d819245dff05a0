"""The image of a scene for an engine with several multipliers that can be reloaded.

Its words go to several memories. The tables come first, each word of them to every lane. Behind
them is a row for each word of the program: that word, the weights of lanes 0 and 1 at the place of
the row's number, one in each half of a word, those of lanes 2 and 3, and so on. A row has a power
of two of words, so the low bits of an address say where a word goes, and the high bits to which
address. What is left of a row is 0, and what is left of the memories is not sent.

A program has no more places of weights than words, because each place but the first, whose weights
are 0, is that of a step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain, zip_longest
from typing import ClassVar

from golden.engine.fields import signed_code
from golden.engine.formats import WIDTH
from golden.engine.function_table import segments_of
from golden.engine.graph import Graph
from golden.engine.image import Sizes
from golden.engine.lane_groups import LaneGraph
from golden.engine.lane_pipeline import LanePipeline
from golden.engine.lane_program import PLACE, LaneProgram, assemble_lanes
from golden.engine.line_table import LineTable
from golden.engine.program import Program
from golden.input_error import InputError

_MASK = (1 << WIDTH) - 1


@dataclass(frozen=True)
class LaneSizes(Sizes):
    """What the hardware of reloadable lanes depends on.

    program_words: Words of the program memory, and of each half of the memory of a lane.
    lanes: An image for fewer lanes leaves the others without work.
    """

    version: ClassVar[int] = 2
    most_program_bits: ClassVar[int] = PLACE[1]
    kind: ClassVar[str] = "words of tables, weights and program"
    pipeline: LanePipeline = field(default_factory=LanePipeline)
    lanes: int = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.table_words > self.program_words:
            raise InputError(
                f"hardware.program_words: got {self.program_words}, expected {self.table_words} or "
                f"more, which the tables of each lane take with segment_width {self.segment_width}"
                + (f" and table_blocks {self.table_blocks}" if self.table_blocks else "")
            )

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
    def hardware(self) -> list[int]:
        return [self.lanes, *super().hardware]

    def assembled(self, graph: Graph, table: LineTable) -> LaneProgram:
        return assemble_lanes(graph, table, self.lanes, self.pipeline, every=True)

    def program_size(self, program: Program) -> int:
        return len(program.words) + self.more

    def laid_out(self, program: Program, graph: Graph) -> tuple[Sequence[int], Sequence[str]]:
        assert isinstance(program, LaneProgram)
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
            shared=LaneGraph(
                self.lanes,
                Graph(inputs, ()),
                (),
                tuple(zip_longest(*halves[: self.lanes], fillvalue=0)),
            ),
        )

    def text(self) -> str:
        return f"{self.lanes} lanes, {super().text()}"


def _halves(weights: Sequence[int]) -> int:
    """The word in whose halves the weights of two lanes, or of one, stand."""
    return sum((weight & _MASK) << n * WIDTH for n, weight in enumerate(weights))
