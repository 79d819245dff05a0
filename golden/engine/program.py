"""The program of an engine: words of 36 bits, and a function that executes them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from golden.engine.fields import get, put, signed_code
from golden.engine.finish import word_of
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH
from golden.engine.function_table import check_words, codes_of
from golden.engine.graph import LOOKED_UP, Graph, Kind, Term
from golden.engine.line_table import LineTable
from golden.engine.listing import text_of
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step, schedule
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
# In programs with ReLU bit 30 means ReLU, and KIND selects intercept or slope instead.
RELU = (30, 1)
FIRST = (31, 1)
FIRST_OF_OUTPUT = (32, 1)
STORE = (33, 1)
OUTPUT = (34, 1)
END = (35, 1)
INTERCEPT = (WIDTH, WIDTH)
SLOPE = (0, WIDTH)

_HALF = 1 << (DROPPED - 1)


@dataclass(frozen=True)
class Instruction:
    """One step, with its fields gathered from the words that hold them."""

    weight: int
    source: int
    kind: int
    take_intercept: int
    first: int
    first_of_output: int
    store: int
    output: int
    end: int
    relu: int = 0


@dataclass(frozen=True)
class Program:
    """The contents of the program memory.

    inputs: Samples of a frame.
    segment_width: Bits of q within a segment of the table.
    table: Words of the table, one per segment. Of a table of one block, the last one also serves
        every segment beyond.
    words: Words of the steps, which follow the table.
    pipeline: The pipeline for which the fields are spread over the words.
    notes: What each word of the table and of the steps stands for.
    rectifies: Whether words hold ``RELU`` instead of ``TAKE_INTERCEPT``.
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

    @cached_property
    def instructions(self) -> list[Instruction]:
        """The steps, up to the end of the frame."""
        at, words = self.pipeline, self.words
        weight_at = weight_place(at, self.names_blocks)
        operand, weight, start, mark = at.operand, at.weight, at.start, at.mark
        found = []
        for n in range(len(words) - mark):
            kind = get(words[n + operand], KIND)
            take_intercept = get(words[n + weight], TAKE_INTERCEPT)
            found.append(
                Instruction(
                    weight=signed_code(get(words[n + weight_at], WEIGHT)),
                    source=get(words[n], SOURCE),
                    kind=kind,
                    take_intercept=(
                        int(kind == Kind.INTERCEPT) if self.rectifies else take_intercept
                    ),
                    first=get(words[n + start], FIRST),
                    first_of_output=get(words[n + start], FIRST_OF_OUTPUT),
                    store=get(words[n + mark], STORE),
                    output=get(words[n + mark], OUTPUT),
                    end=get(words[n + mark], END),
                    relu=get(words[n + mark], RELU) if self.rectifies else 0,
                )
            )
            if found[-1].end:
                break
        return found

    @property
    def output_steps(self) -> list[int]:
        """The steps whose results leave the engine."""
        return [n for n, step in enumerate(self.instructions) if step.output]

    @property
    def length(self) -> int:
        """The number of steps."""
        return len(self.instructions)

    @property
    def store_steps(self) -> list[int]:
        """The steps whose results are stored."""
        return [n for n, step in enumerate(self.instructions) if step.store]

    @cached_property
    def intercepts(self) -> Codes:
        """The intercept of each segment."""
        return np.array([signed_code(get(word, INTERCEPT)) for word in self.table])

    @cached_property
    def slopes(self) -> Codes:
        """The slope of each segment."""
        return np.array([signed_code(get(word, SLOPE)) for word in self.table])

    @property
    def segments(self) -> int:
        """The number of segments in each block of the table."""
        return len(self.slopes) // self.blocks

    def scheduled(self, graph: Graph) -> list[Step]:
        """The steps of the graph from which the program was assembled."""
        return schedule(graph, self.pipeline)

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
        results = [word >> OUTPUT_SHIFT for step, _, word in self.run(samples) if step.output]
        return np.stack(results, axis=-1)

    def stored(self, graph: Graph, samples: Codes) -> Iterator[tuple[int, bool, Codes, Codes]]:
        """Each neuron as it is stored: its number, whether it is a ReLU, its sums, their words."""
        order = [step.neuron for step in self.scheduled(graph) if step.last]
        for number, (step, sums, word) in zip(order, self.run(samples), strict=True):
            yield number, bool(step.relu), sums, word

    def run(self, samples: Codes) -> Iterator[tuple[Instruction, Codes, Codes]]:
        """The last step of each neuron in the order of the program, its sums, and their words."""
        memory = [np.ascontiguousarray(samples[:, k]) << SAMPLE_SHIFT for k in range(self.inputs)]
        intercepts, slopes = self.intercepts, self.slopes
        distances = 1 << self.segment_width
        segments: tuple[tuple[int, int], Codes, Codes] | None = None
        acc = product = np.zeros(len(samples), dtype=np.int64)
        for step in self.instructions:
            if step.kind == Kind.ONE:
                product = np.asarray(step.weight << DROPPED)
            elif step.kind == Kind.WORD:
                product = memory[step.source] * step.weight if step.weight else np.asarray(0)
            else:
                word = memory[step.source]
                if segments is None or segments[0] != (step.source, step.weight):
                    negative = word >> (WIDTH - 1)
                    segment = (word ^ negative) >> self.segment_width
                    np.minimum(segment, self.segments - 1, out=segment)
                    block = (step.weight >> 1) | (negative & step.weight & 1)
                    segments = (
                        (step.source, step.weight),
                        negative,
                        segment + block * self.segments,
                    )
                coeffs = intercepts if step.take_intercept else slopes
                if step.kind == Kind.INTERCEPT:
                    # This operand is the number one with the sign of the word.
                    product = coeffs[segments[2]] * ((segments[1] | 1) << DROPPED)
                else:
                    product = coeffs[segments[2]] * ((word & (distances - 1)) - distances // 2)
            if step.first:
                half = _HALF << (OUTPUT_SHIFT if step.first_of_output else 0)
                acc = np.broadcast_to(product + half, len(samples))
            else:
                acc = acc + product
            if step.store:
                word = word_of(acc, step.relu, self.cut, self.even)
                memory.append(word)
                yield step, acc, word


def weight_place(pipeline: Pipeline, names_blocks: bool) -> int:
    """How many words behind the one of its source the weight of a step is stored.

    A block of the table is looked up sooner than a weight is multiplied. Where steps name blocks,
    the weight stands with the kind, and the hardware delays it.
    """
    return pipeline.operand if names_blocks else pipeline.weight


def weight_of(term: Term, codes: Mapping[Function, int]) -> int:
    """What the field of a step's weight holds: the weight, or the code of the table."""
    return codes[term.function] if term.kind in LOOKED_UP else term.weight


def assemble(
    graph: Graph, table: LineTable, pipeline: Pipeline, rectifies: bool = False
) -> Program:
    """The program of a graph.

    table: The table of the graph's functions, all of which the program holds.
    rectifies: Whether the hardware has ReLU, even if the graph has none.
    """
    check_values(graph)
    check_words(table)
    rectifies = rectifies or graph.rectifies
    steps = schedule(graph, pipeline)
    operand, weight = pipeline.operand, pipeline.weight
    start, mark = pipeline.start, pipeline.mark
    words = [0] * (len(steps) + mark + pipeline.padding)
    addresses = {k: k for k in range(graph.inputs)} | {-1: 0}
    codes = codes_of(graph.functions)
    weight_at = weight_place(pipeline, table.blocks > 1)
    final = len(steps) - 1
    for n, step in enumerate(steps):
        term = step.term
        if step.last:
            addresses[graph.inputs + step.neuron] = len(addresses) - 1
        neuron = graph.neurons[step.neuron]
        output = step.neuron >= 0 and neuron.output
        put(words, n, SOURCE, addresses[term.source])
        put(words, n + operand, KIND, int(term.kind))
        put(words, n + weight_at, WEIGHT, weight_of(term, codes))
        if rectifies:
            put(words, n + mark, RELU, step.last and neuron.relu)
        else:
            put(words, n + weight, TAKE_INTERCEPT, term.kind is Kind.INTERCEPT)
        put(words, n + start, FIRST, step.first)
        put(words, n + start, FIRST_OF_OUTPUT, step.first and output)
        put(words, n + mark, STORE, step.last)
        put(words, n + mark, OUTPUT, step.last and output)
        put(words, n + mark, END, n == final)
    notes = (*table_notes(table), *_step_notes(graph, steps, len(words)))
    return Program(
        graph.inputs,
        table.width,
        table_words(table),
        tuple(words),
        pipeline,
        notes,
        rectifies,
        graph.cut,
        graph.even,
        table.blocks,
    )


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


def _step_notes(graph: Graph, steps: Sequence[Step], count: int) -> list[str]:
    behind = ["fields of steps above"] * (count - len(steps))
    return [text_of(graph, step) for step in steps] + behind
