"""What programs have in common, and the fields of the words of an engine that learns."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from golden.engine.formats import WIDTH
from golden.engine.graph import LOOKED_UP, Graph, Term
from golden.engine.line_table import LineTable
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step
from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.trained.function import Function

WORD_WIDTH = 36
# The fields of a word: lowest bit, and number of bits. A word of the table holds a slope and an
# intercept. Where there are several blocks of the table, the weight of a step that looks up names
# the block; see golden/engine/function_table.py.
WEIGHT = (0, WIDTH)
SOURCE = (18, 10)
KIND = (28, 2)
TAKE_INTERCEPT = (30, 1)
FIRST = (31, 1)
FIRST_OF_OUTPUT = (32, 1)
STORE = (33, 1)
OUTPUT = (34, 1)
END = (35, 1)
INTERCEPT = (WIDTH, WIDTH)
SLOPE = (0, WIDTH)


class Marked(Protocol):
    """What every step of a program says of its result."""

    @property
    def store(self) -> int: ...

    @property
    def output(self) -> int: ...


@dataclass(frozen=True)
class Program:
    """The contents of the program memory.

    inputs: Samples of a frame.
    segment_width: Bits of q within a segment of the table.
    table: Words of the table.
    words: Words of the steps.
    pipeline: The pipeline for which the fields are spread over the words.
    notes: What each word stands for.
    rectifies: Whether the hardware has ReLU.
    even: Of results with ReLU; see ``Neuron``.
    blocks: Blocks of the table; see ``LineTable``.
    """

    inputs: int
    segment_width: int
    table: tuple[int, ...]
    words: tuple[int, ...]
    pipeline: Pipeline
    notes: tuple[str, ...]
    rectifies: bool = False
    cut: int = 0
    even: bool = False
    blocks: int = 1

    @property
    def names_blocks(self) -> bool:
        """Whether steps say in which block of the table they look up."""
        return self.blocks > 1

    @property
    def steps(self) -> Sequence[Marked]:
        """The steps, up to the end of the frame."""
        raise NotImplementedError

    @property
    def output_steps(self) -> list[int]:
        """The steps whose results leave the engine."""
        return [n for n, step in enumerate(self.steps) if step.output]

    @property
    def length(self) -> int:
        """The number of steps."""
        return len(self.steps)

    @property
    def store_steps(self) -> list[int]:
        """The steps whose results are stored."""
        return [n for n, step in enumerate(self.steps) if step.store]

    @cached_property
    def intercepts(self) -> Codes:
        """The intercept of each segment."""
        raise NotImplementedError

    @cached_property
    def slopes(self) -> Codes:
        """The slope of each segment."""
        raise NotImplementedError

    @property
    def segments(self) -> int:
        """The number of segments in each block of the table."""
        return len(self.slopes) // self.blocks

    def scheduled(self, graph: Graph) -> list[Step]:
        """The steps of the graph from which the program was assembled."""
        raise NotImplementedError

    def clock(self, step: int) -> int:
        """The clock in which a step's result is valid, counted from a frame's last sample."""
        return self.pipeline.begin + step + self.pipeline.result

    @property
    def addresses(self) -> int:
        """The number of words of the operand memory that the program uses."""
        return self.inputs + len(self.store_steps)

    def execute(self, samples: Codes) -> Codes:
        """Compute output codes, shape (frames, outputs), from sample codes, shape (frames, inputs).

        The steps are those of the hardware; only the sum has more bits here.
        """
        raise NotImplementedError

    def stored(self, graph: Graph, samples: Codes) -> Iterator[tuple[int, bool, Codes, Codes]]:
        """Each neuron as it is stored: its number, whether it is a ReLU, its sums, their words."""
        raise NotImplementedError


def weight_of(term: Term, codes: Mapping[Function, int]) -> int:
    """What the field of a step's weight holds: the weight, or the code of the table."""
    return codes[term.function] if term.kind in LOOKED_UP else term.weight


def check_values(graph: Graph) -> None:
    """Refuse a graph that is too large."""
    values, most = graph.inputs + len(graph.neurons), (1 << SOURCE[1]) - 1
    if values > most:
        raise InputError(
            f"program: got {values} words of the operand memory, {graph.inputs} samples and "
            f"{len(graph.neurons)} results, expected {most} at most"
        )


def table_words(table: LineTable) -> tuple[int, ...]:
    """The words of a table."""
    pairs = zip(table.intercepts, table.slopes, strict=True)
    mask = (1 << WIDTH) - 1
    return tuple(((intercept & mask) << WIDTH) | (slope & mask) for intercept, slope in pairs)


def table_notes(table: LineTable) -> list[str]:
    """What the words of a table stand for."""
    found = []
    for block, (name, result) in enumerate(table.labels):
        place = slice(block * table.segments, (block + 1) * table.segments)
        pairs = zip(
            result.texts(table.intercepts[place]), result.texts(table.slopes[place]), strict=True
        )
        found += [f"{name} {intercept}, slope {slope}" for intercept, slope in pairs]
    return found
