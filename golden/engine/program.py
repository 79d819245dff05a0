"""The program of an engine: words of 36 bits, and what executing them computes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, RESULT, SAMPLE_SHIFT, WIDTH
from golden.engine.graph import Graph, Kind
from golden.engine.listing import text_of
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step, schedule
from golden.engine.tanh_table import TanhTable
from golden.fixed import Codes, Fix

WORD_WIDTH = 36
# The fields of a word: lowest bit, and bits. A word of the table has a slope and an intercept.
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

_WORD = Fix(WIDTH, 0)
_HALF = 1 << (DROPPED - 1)


@dataclass(frozen=True)
class Instruction:
    """One step, its fields gathered from the words in which they stand."""

    weight: int
    source: int
    kind: int
    take_intercept: int
    first: int
    first_of_output: int
    store: int
    output: int
    end: int


@dataclass(frozen=True)
class Program:
    """The contents of the program memory.

    Parameters
    ----------
    inputs : int
        Samples of a frame.
    segment_width : int
        Bits of q within a segment of the table of tanh.
    table : tuple of int
        Its words, one per segment; the last holds for every segment beyond.
    words : tuple of int
        The words of the steps, which follow the table.
    pipeline : Pipeline
        For which hardware the fields are spread over the words.
    notes : tuple of str
        What each word of table and steps stands for.
    """

    inputs: int
    segment_width: int
    table: tuple[int, ...]
    words: tuple[int, ...]
    pipeline: Pipeline
    notes: tuple[str, ...]

    @property
    def instructions(self) -> list[Instruction]:
        """The steps, up to the end of the frame."""
        at = self.pipeline
        found = []
        for n in range(len(self.words) - at.mark):
            found.append(
                Instruction(
                    weight=_signed(_get(self.words[n + at.weight], WEIGHT)),
                    source=_get(self.words[n], SOURCE),
                    kind=_get(self.words[n + at.operand], KIND),
                    take_intercept=_get(self.words[n + at.weight], TAKE_INTERCEPT),
                    first=_get(self.words[n + at.start], FIRST),
                    first_of_output=_get(self.words[n + at.start], FIRST_OF_OUTPUT),
                    store=_get(self.words[n + at.mark], STORE),
                    output=_get(self.words[n + at.mark], OUTPUT),
                    end=_get(self.words[n + at.mark], END),
                )
            )
            if found[-1].end:
                break
        return found

    @property
    def output_steps(self) -> list[int]:
        """The steps whose results leave."""
        return [n for n, step in enumerate(self.instructions) if step.output]

    def clock(self, step: int) -> int:
        """The clock, from a frame's last sample on, in which a step's result is there."""
        return self.pipeline.begin + step + self.pipeline.result

    @property
    def addresses(self) -> int:
        """Words of the operand memory that are used."""
        return self.inputs + sum(step.store for step in self.instructions)

    def execute(self, samples: Codes) -> Codes:
        """Output codes, shape (frames, outputs), of sample codes, shape (frames, inputs).

        Step by step as the hardware does it; only the sum is wider.
        """
        memory = [np.ascontiguousarray(samples[:, k]) << SAMPLE_SHIFT for k in range(self.inputs)]
        intercepts = np.array([_signed(_get(word, INTERCEPT)) for word in self.table])
        slopes = np.array([_signed(_get(word, SLOPE)) for word in self.table])
        distances = 1 << self.segment_width
        segments: tuple[int, Codes, Codes] | None = None
        acc = product = np.zeros(len(samples), dtype=np.int64)
        results = []
        for step in self.instructions:
            if step.kind == Kind.ONE:
                product = np.asarray(step.weight << DROPPED)
            elif step.kind == Kind.WORD:
                product = memory[step.source] * step.weight if step.weight else np.asarray(0)
            else:
                word = memory[step.source]
                if segments is None or segments[0] != step.source:
                    negative = word >> (WIDTH - 1)
                    segment = (word ^ negative) >> self.segment_width
                    np.minimum(segment, len(self.table) - 1, out=segment)
                    segments = step.source, negative, segment
                coeffs = intercepts if step.take_intercept else slopes
                if step.kind == Kind.INTERCEPT:
                    # The number one with the word's sign.
                    product = coeffs[segments[2]] * ((segments[1] | 1) << DROPPED)
                else:
                    product = coeffs[segments[2]] * ((word & (distances - 1)) - distances // 2)
            if step.first:
                half = _HALF << (OUTPUT_SHIFT if step.first_of_output else 0)
                acc = np.broadcast_to(product + half, len(samples))
            else:
                acc = acc + product
            if step.store:
                word = np.clip(acc >> DROPPED, _WORD.low, _WORD.high)
                memory.append(word)
                if step.output:
                    results.append(word >> OUTPUT_SHIFT)
        return np.stack(results, axis=-1)


def assemble(
    graph: Graph, table: TanhTable, segments: int, pipeline: Pipeline
) -> tuple[Program, list[Step]]:
    """The program of a graph, and its steps.

    Parameters
    ----------
    graph : Graph
    table : TanhTable
    segments : int
        Words of the table that are kept.
    pipeline : Pipeline

    Raises
    ------
    ValueError
        When the samples and results of a frame are more than a program can address.
    """
    values, most = graph.inputs + len(graph.neurons), (1 << SOURCE[1]) - 1
    if values > most:
        raise ValueError(
            f"program: got {values} words of the operand memory, {graph.inputs} samples and "
            f"{len(graph.neurons)} results, expected {most} at most"
        )
    steps = schedule(graph, pipeline)
    words = [0] * (len(steps) + pipeline.mark + pipeline.padding)
    addresses = {k: k for k in range(graph.inputs)} | {-1: 0}
    final = len(steps) - 1
    for n, step in enumerate(steps):
        term = step.term
        if step.last:
            addresses[graph.inputs + step.neuron] = len(addresses) - 1
        output = step.neuron >= 0 and graph.neurons[step.neuron].output
        _put(words, n, SOURCE, addresses[term.source])
        _put(words, n + pipeline.operand, KIND, int(term.kind))
        _put(words, n + pipeline.weight, WEIGHT, term.weight)
        _put(words, n + pipeline.weight, TAKE_INTERCEPT, term.kind is Kind.INTERCEPT)
        _put(words, n + pipeline.start, FIRST, step.first)
        _put(words, n + pipeline.start, FIRST_OF_OUTPUT, step.first and output)
        _put(words, n + pipeline.mark, STORE, step.last)
        _put(words, n + pipeline.mark, OUTPUT, step.last and output)
        _put(words, n + pipeline.mark, END, n == final)
    kept = table_words(table, segments)
    notes = (*_table_notes(table, segments), *_step_notes(graph, steps, len(words)))
    return Program(graph.inputs, table.width, kept, tuple(words), pipeline, notes), steps


def table_words(table: TanhTable, segments: int) -> tuple[int, ...]:
    """The first words of the table."""
    pairs = zip(table.intercepts[:segments], table.slopes[:segments], strict=True)
    mask = (1 << WIDTH) - 1
    return tuple((intercept << WIDTH) | (slope & mask) for intercept, slope in pairs)


def _table_notes(table: TanhTable, segments: int) -> list[str]:
    intercepts = RESULT.texts(table.intercepts[:segments])
    slopes = RESULT.texts(table.slopes[:segments])
    return [f"tanh {i}, slope {s}" for i, s in zip(intercepts, slopes, strict=True)]


def _step_notes(graph: Graph, steps: Sequence[Step], count: int) -> list[str]:
    behind = ["fields of steps above"] * (count - len(steps))
    return [text_of(graph, step) for step in steps] + behind


def _put(words: list[int], place: int, field: tuple[int, int], value: int) -> None:
    low, bits = field
    words[place] |= (int(value) & ((1 << bits) - 1)) << low


def _get(word: int, field: tuple[int, int]) -> int:
    low, bits = field
    return (word >> low) & ((1 << bits) - 1)


def _signed(code: int) -> int:
    return code - ((code >> (WIDTH - 1)) << WIDTH)
