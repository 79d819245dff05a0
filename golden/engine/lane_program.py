"""The program of an engine with several multipliers, and a function that executes it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from golden.engine.fields import get, put, signed_code
from golden.engine.finish import word_of
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH
from golden.engine.function_table import SEGMENT_WIDTH, check_words, codes_of, joined
from golden.engine.graph import Graph, Kind
from golden.engine.lane_groups import LaneGraph, assign_to_lanes, reduction_steps
from golden.engine.lane_memory import block_of
from golden.engine.lane_pipeline import LanePipeline
from golden.engine.line_table import LineTable
from golden.engine.listing import operand_text
from golden.engine.program import Program, weight_of
from golden.engine.schedule import Step
from golden.input_error import InputError
from golden.numbers.fixed import Codes

# The fields of a word of the program: lowest bit, and number of bits. The weights are not in it,
# but in the memory of each lane, all at the same place. In a step that looks up a function, the
# place names its block, if there are several; see golden/engine/function_table.py.
PLACE = (0, 13)
SOURCE = (13, 10)
KIND = (23, 2)
# Whether a sum starts. All lanes start one each, or they start to add up one neuron together, whose
# half unit counts once; it is that of an output or of any other neuron.
OPENS = (25, 2)
NO_SUM, OWN, JOINED, JOINED_OUTPUT = range(4)
# Bit k is set in the k-th of the steps that add up the sums of lanes.
GATHER = (27, 4)
STORE = (31, 1)
# Every lane stores the result of the first one.
TOGETHER = (32, 1)
RELU = (33, 1)
OUTPUT = (34, 1)
END = (35, 1)
FIELDS = {
    "place": PLACE,
    "source": SOURCE,
    "kind": KIND,
    "opens": OPENS,
    "gather": GATHER,
    "store": STORE,
    "together": TOGETHER,
    "relu": RELU,
    "output": OUTPUT,
    "end": END,
}


@dataclass(frozen=True)
class LaneInstruction:
    """One step, with its fields gathered from the words that hold them."""

    place: int
    source: int
    kind: int
    opens: int
    gather: int
    store: int
    together: int
    relu: int
    output: int
    end: int


@dataclass(frozen=True)
class LaneProgram(Program):
    """The contents of the program memory, and of the memories of the lanes.

    shared: The groups from which it was assembled.
    """

    shared: LaneGraph = field(kw_only=True)

    @property
    def lanes(self) -> int:
        return self.shared.lanes

    @property
    def weights(self) -> tuple[tuple[int, ...], ...]:
        """For each place the weight of each lane."""
        return self.shared.weights

    def field(self, name: str) -> tuple[int, int]:
        """The lowest bit of a field in a word, and its number of bits."""
        return FIELDS[name]

    @cached_property
    def intercepts(self) -> Codes:
        return np.array([signed_code(word) for word in self.table[: len(self.table) // 2]])

    @cached_property
    def slopes(self) -> Codes:
        return np.array([signed_code(word) for word in self.table[len(self.table) // 2 :]])

    @cached_property
    def lane_steps(self) -> list[LaneInstruction]:
        """The steps, up to the end of the frame."""
        at, words = self.pipeline, self.words
        assert isinstance(at, LanePipeline)
        found: list[LaneInstruction] = []
        for n in range(len(words) - at.mark):
            early, start, late = words[n + at.operand], words[n + at.start], words[n + at.mark]
            found.append(
                LaneInstruction(
                    place=get(words[n + at.place], PLACE),
                    source=get(words[n], SOURCE),
                    kind=get(early, KIND),
                    opens=get(start, OPENS),
                    gather=get(words[n + at.gather], GATHER),
                    store=get(late, STORE),
                    together=get(late, TOGETHER),
                    relu=get(late, RELU),
                    output=get(late, OUTPUT),
                    end=get(late, END),
                )
            )
            if found[-1].end:
                break
        return found

    @property
    def output_steps(self) -> list[int]:
        return [n for n, step in enumerate(self.lane_steps) if step.output]

    @property
    def length(self) -> int:
        return len(self.lane_steps)

    @property
    def store_steps(self) -> list[int]:
        return [n for n, step in enumerate(self.lane_steps) if step.store]

    def scheduled(self, graph: Graph) -> list[Step]:
        """The steps of the groups."""
        return self.shared.schedule(self.pipeline)

    def execute(self, samples: Codes) -> Codes:
        results = [
            words[0] >> OUTPUT_SHIFT for step, _, words in self.lanes_run(samples) if step.output
        ]
        return np.stack(results, axis=-1)

    def stored(self, graph: Graph, samples: Codes) -> Iterator[tuple[int, bool, Codes, Codes]]:
        order = [step.neuron for step in self.scheduled(graph) if step.last]
        for number, (step, sums, words) in zip(order, self.lanes_run(samples), strict=True):
            for lane, neuron in enumerate(self.shared.groups[number].members):
                if neuron >= 0:
                    yield neuron, bool(step.relu), sums[lane], words[lane]

    def weight_notes(self, graph: Graph, lane: int) -> list[str]:
        """What the words of the table stand for, and behind them the weights of a lane."""
        shared = self.shared
        found = {0: "none"}
        blocks = joined(graph.functions, self.segment_width).labels
        for number, group in zip(shared.groups, shared.graph.neurons, strict=True):
            members = number.members if not (number.joined or number.alike) else ()
            named = members[lane] if lane < len(members) else -1
            name = graph.neurons[named].name if named >= 0 else group.name
            for term in group.terms:
                text = f"{name}: {operand_text(shared.graph, Step(0, term))}"
                found.setdefault(term.weight, text)
        texts = [found[place] for place in range(len(self.weights))]
        labels = "intercept of segment", "slope of segment"
        names = ["" if len(blocks) == 1 else f"{name}: " for name, _ in blocks]
        names += ["not used: "] * (self.blocks - len(names))
        return [
            f"{name}{label} {n}" for label in labels for name in names for n in range(self.segments)
        ] * bool(self.table) + texts

    def lanes_run(
        self, samples: Codes
    ) -> Iterator[tuple[LaneInstruction, list[Codes], list[Codes]]]:
        """The last step of each group, the sum of each lane, and the word that it stores."""
        lanes, zero = range(self.lanes), np.zeros(len(samples), dtype=np.int64)
        first = [np.ascontiguousarray(samples[:, k]) << SAMPLE_SHIFT for k in range(self.inputs)]
        memories = [list(first) for _ in lanes]
        sums = [zero for _ in lanes]
        for step in self.lane_steps:
            if step.gather:
                pairs = dict(reduction_steps(self.lanes)[step.gather.bit_length() - 1])
                added = [sums[pairs[j]] if j in pairs else zero for j in lanes]
            else:
                weights = self.weights[step.place]
                added = [self._product(step, memories[j], weights[j], zero) for j in lanes]
            if step.opens:
                sums = [zero + start_of(step.opens, lane) for lane in lanes]
            sums = [total + value for total, value in zip(sums, added, strict=True)]
            if step.store:
                words = [word_of(total, step.relu, self.cut, self.even) for total in sums]
                if step.together:
                    words = [words[0] for _ in lanes]
                for memory, word in zip(memories, words, strict=True):
                    memory.append(word)
                yield step, sums, words

    def _product(
        self, step: LaneInstruction, memory: list[Codes], weight: int, zero: Codes
    ) -> Codes:
        if step.kind == Kind.ONE:
            return zero + (weight << DROPPED)
        # A step that waits may name an address that is not written yet.
        if step.kind == Kind.WORD:
            return memory[step.source] * weight if weight else zero
        word = memory[step.source]
        negative = word >> (WIDTH - 1)
        segment = ((word ^ negative) >> self.segment_width) & (self.segments - 1)
        if self.names_blocks:
            segment += block_of(step.place, negative & 1) * self.segments
        if step.kind == Kind.INTERCEPT:
            return np.asarray(self.intercepts[segment] * ((negative | 1) << DROPPED))
        span = 1 << self.segment_width
        return np.asarray(self.slopes[segment] * ((word & (span - 1)) - span // 2))


def start_of(opens: int, lane: int) -> int:
    """The value with which the sum of a lane starts."""
    half = 1 << (DROPPED - 1)
    if opens == OWN:
        return half
    return 0 if lane else half << (OUTPUT_SHIFT if opens == JOINED_OUTPUT else 0)


def assemble_lanes(
    graph: Graph,
    table: LineTable | None,
    lanes: int,
    pipeline: LanePipeline,
    every: bool = False,
) -> LaneProgram:
    """The program of a graph.

    table: That of the graph's functions; None where no neuron looks anything up.
    every: Whether all of these lanes are there, even if the graph has no work for some.
    """
    if table:
        check_words(table)
    shared = assign_to_lanes(graph, lanes, every)
    _check(shared)
    steps = shared.schedule(pipeline)
    words = [0] * (len(steps) + pipeline.mark + pipeline.padding)
    addresses = {k: k for k in range(graph.inputs)} | {-1: 0}
    codes = codes_of(graph.functions)
    left = 0
    for n, step in enumerate(steps):
        term, wait = step.term, step.neuron < 0
        neuron, group = shared.graph.neurons[step.neuron], shared.groups[step.neuron]
        if step.first:
            left = len(neuron.terms)
        # What follows the terms of a group adds up the sums of lanes.
        adds = not wait and left <= 0
        if step.last:
            addresses[graph.inputs + step.neuron] = len(addresses) - 1
        put(words, n, SOURCE, addresses[term.source])
        put(words, n + pipeline.operand, KIND, int(term.kind))
        put(words, n + pipeline.place, PLACE, weight_of(term, codes))
        opens = OWN if not group.joined else JOINED_OUTPUT if neuron.output else JOINED
        put(words, n + pipeline.start, OPENS, opens if step.first else NO_SUM)
        put(words, n + pipeline.gather, GATHER, 1 << -left if adds else 0)
        put(words, n + pipeline.mark, STORE, step.last)
        put(words, n + pipeline.mark, TOGETHER, step.last and group.joined)
        put(words, n + pipeline.mark, RELU, step.last and neuron.relu)
        put(words, n + pipeline.mark, OUTPUT, step.last and neuron.output)
        put(words, n + pipeline.mark, END, n == len(steps) - 1)
        left -= not wait
    return LaneProgram(
        graph.inputs,
        table.width if table else SEGMENT_WIDTH,
        _table_words(table) if table else (),
        tuple(words),
        pipeline,
        (*_notes(shared, steps), *["fields of steps above"] * (len(words) - len(steps))),
        graph.rectifies,
        graph.cut,
        graph.even,
        1 << (table.blocks - 1).bit_length() if table else 1,
        shared=shared,
    )


def _table_words(table: LineTable) -> tuple[int, ...]:
    """All intercepts, and behind them all slopes; of each a power of two, the last one repeated.

    So the number of blocks is a power of two as well.
    """
    count = 1 << (len(table.slopes) - 1).bit_length()
    mask = (1 << WIDTH) - 1
    return tuple(
        code & mask
        for codes in (table.intercepts, table.slopes)
        for code in codes + codes[-1:] * (count - len(codes))
    )


def _check(shared: LaneGraph) -> None:
    graph, most = shared.graph, (1 << SOURCE[1]) - 1
    values = graph.inputs + len(graph.neurons)
    if values > most:
        raise InputError(
            f"program: got {values} words of the operand memory, {graph.inputs} samples and "
            f"{len(graph.neurons)} results, expected {most} at most"
        )
    if len(shared.weights) > 1 << PLACE[1]:
        raise InputError(
            f"program: got {len(shared.weights)} weights of each lane, expected {1 << PLACE[1]} at "
            "most; more lanes have fewer each"
        )


def _notes(shared: LaneGraph, steps: Sequence[Step]) -> Iterator[str]:
    """What each step does."""
    left = 0
    for step in steps:
        if step.neuron < 0:
            yield "wait"
            continue
        neuron = shared.graph.neurons[step.neuron]
        left = len(neuron.terms) if step.first else left - 1
        joint = f"{neuron.name} {'=' if step.first else '+'}"
        added = "sums of lanes" if left <= 0 else operand_text(shared.graph, step)
        yield f"{joint} {added}{', done' if step.last else ''}"
