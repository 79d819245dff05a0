"""The program of an engine without a multiplier: all fields of a step stand in one word."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np

from golden.engine.fields import get, put, signed_code
from golden.engine.finish import word_of
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH
from golden.engine.function_table import check_words, codes_of
from golden.engine.graph import Graph, Kind
from golden.engine.line_table import LineTable
from golden.engine.listing import text_of
from golden.engine.pipeline import SerialPipeline
from golden.engine.program import (
    KIND,
    SOURCE,
    WEIGHT,
    Program,
    check_values,
    table_notes,
    weight_of,
)
from golden.engine.replay import Replay, replay_of, replayed
from golden.engine.schedule import Step, schedule
from golden.numbers.fixed import Codes

# Marks the last word of a pass: of those that read only deep words, of those that read wide words
# too, or of the pass that reads all.
END = (30, 2)
DEEP, WIDE, ALL = 1, 2, 3
# Marks the sum of an output, which is rounded to fewer bits.
OF_OUTPUT = (32, 1)
# In a neuron's first word: what happens to the sum of the neuron before.
BEFORE = (33, 2)
NOTHING, STORED, LEAVES, ENDS = range(4)
# Beside it, whether that sum becomes 0 where it is below.
RELU_BEFORE = (35, 1)
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
class SerialProgram(Program):
    """The contents of the program memory: alternating slopes and intercepts, then the words.

    One more word follows those of the last neuron. It says what happens to that neuron's sum, and
    it is read until the program stops.
    """

    @cached_property
    def intercepts(self) -> Codes:
        return np.array([signed_code(word) for word in self.table[1::2]])

    @cached_property
    def slopes(self) -> Codes:
        return np.array([signed_code(word) for word in self.table[::2]])

    @property
    def steps(self) -> list[Instruction]:
        return self.instructions

    @cached_property
    def instructions(self) -> list[Instruction]:
        found = []
        first = True
        for word, following in zip(self.words, self.words[1:], strict=False):
            last = get(word, END) == ALL
            then = get(following, BEFORE) if last else NOTHING
            found.append(
                Instruction(
                    weight=signed_code(get(word, WEIGHT)),
                    source=get(word, SOURCE),
                    kind=get(word, KIND),
                    take_intercept=get(word, KIND) == Kind.INTERCEPT,
                    first=first,
                    first_of_output=first and get(word, OF_OUTPUT),
                    store=then != NOTHING,
                    output=then in (LEAVES, ENDS),
                    end=then == ENDS,
                    relu=get(following, RELU_BEFORE) if last else 0,
                )
            )
            first = last
        return found

    def scheduled(self, graph: Graph) -> list[Step]:
        return schedule(graph, self.pipeline, replayed)

    def execute(self, samples: Codes) -> Codes:
        results = [word >> OUTPUT_SHIFT for step, _, word in self.run(samples) if step.output]
        return np.stack(results, axis=-1)

    def stored(self, graph: Graph, samples: Codes) -> Iterator[tuple[int, bool, Codes, Codes]]:
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

    def clock(self, step: int) -> int:
        """The clock of the result of a step's neuron, counted from a frame's last sample."""
        clocks = sum(replay.clocks for place, replay in self._neurons() if place <= step)
        return self.pipeline.begin + clocks - 1 + self.pipeline.result

    def _neurons(self) -> Iterator[tuple[int, Replay]]:
        """The index of each neuron's first word, and how many words its passes read."""
        place = 0
        while place < len(self.words) - 1:
            ends = [get(word, END) for word in self.words[place:]]
            deep, wide, words = (
                next(k + 1 for k, found in enumerate(ends) if found >= end)
                for end in (DEEP, WIDE, ALL)
            )
            yield place, Replay(deep, wide, words)
            place += words


def assemble_serial(graph: Graph, table: LineTable, pipeline: SerialPipeline) -> SerialProgram:
    """The program of a graph. ``table`` is that of all functions of the graph."""
    check_values(graph)
    check_words(table)
    codes = codes_of(graph.functions)
    steps = schedule(graph, pipeline, replayed)
    words = [0] * (len(steps) + 1)
    addresses = {k: k for k in range(graph.inputs)} | {-1: 0}
    place = 0
    for number, group in groupby(steps, key=lambda step: step.neuron):
        terms = tuple(step.term for step in group)
        replay = replay_of(graph, terms)
        output = graph.neurons[number].output
        for k, term in enumerate(terms, start=place):
            put(words, k, WEIGHT, weight_of(term, codes))
            put(words, k, SOURCE, addresses[term.source])
            put(words, k, KIND, int(term.kind))
            put(words, k, OF_OUTPUT, output)
        ends = {replay.deep: DEEP} | {replay.wide: WIDE} | {replay.words: ALL}
        for length, end in ends.items():
            put(words, place + length - 1, END, end)
        place += replay.words
        put(words, place, BEFORE, LEAVES if output else STORED)
        put(words, place, RELU_BEFORE, graph.neurons[number].relu)
        addresses[graph.inputs + number] = len(addresses) - 1
    put(words, place, BEFORE, ENDS)
    put(words, place, END, ALL)
    pairs = zip(table.slopes, table.intercepts, strict=True)
    mask = (1 << WIDTH) - 1
    kept = tuple(code & mask for pair in pairs for code in pair)
    table_texts = [note for pair in table_notes(table) for note in pair.split(", ")[::-1]]
    texts = [text_of(graph, step) for step in steps]
    return SerialProgram(
        graph.inputs,
        table.width,
        kept,
        tuple(words),
        pipeline,
        (*table_texts, *texts, "what becomes of the last sum"),
        graph.rectifies,
        graph.cut,
        graph.even,
        table.blocks,
    )
