"""The program of an engine with one multiplier or several, and a function that executes it."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from types import SimpleNamespace
from typing import Self, TypeVar

import numpy as np

from golden.engine.formats import (
    DROPPED,
    ONE,
    OUTPUT_SHIFT,
    SAMPLE_SHIFT,
    WIDTH,
    coeff_frac,
    get,
    put,
    signed_code,
    word_of,
)
from golden.engine.function_table import (
    SEGMENT_WIDTH,
    LineTable,
    check_words,
    codes_of,
    joined,
    segments_of,
)
from golden.engine.graph import LOOKED_UP, Graph, Kind
from golden.engine.lane_groups import LaneGraph, assign_to_lanes, reduction_steps
from golden.engine.memories import Tabled, block_of
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step
from golden.input_error import InputError
from golden.numbers.fixed import Codes

# Whether a sum starts. All lanes start one each, or they start to add up one neuron together, whose
# half unit counts once; it is that of an output or of any other neuron.
NO_SUM, OWN, JOINED, JOINED_OUTPUT = range(4)
# The fields of a step: the clock of a pipeline in which each is used, and its bits in a word of 36
# bits. The word of that clock holds it, so the control path needs no registers of its own.
#
# place: The place of the weights in the memories of the lanes; in a step that looks up a function,
#     its block, if there are several (golden/engine/function_table.py).
# gather: Bit k is set in the k-th of the steps that add up the sums of lanes.
# together: Every lane stores the result of the first one.
FIELDS = {
    "place": ("place", 13),
    "source": ("address", 10),
    "kind": ("operand", 2),
    "opens": ("start", 2),
    "gather": ("gather", 4),
    "store": ("mark", 1),
    "together": ("mark", 1),
    "relu": ("mark", 1),
    "output": ("mark", 1),
    "end": ("mark", 1),
}
Row = TypeVar("Row")


@dataclass(frozen=True)
class Layout:
    """Where a word has its fields, from the lowest bit on.

    widths: The bits of each; a field without bits is always 0.
    """

    widths: tuple[int, ...] = tuple(bits for _, bits in FIELDS.values())

    @classmethod
    def of(cls, lanes: int) -> Self:
        """That of a word of 36 bits. A single lane has the bits of two fields for its places."""
        fields = {name: bits for name, (_, bits) in FIELDS.items()}
        if lanes == 1:
            fields["place"] += fields["gather"] + fields["together"]
            fields |= {"gather": 0, "together": 0}
        return cls(tuple(fields.values()))

    def __getitem__(self, name: str) -> tuple[int, int]:
        """The lowest bit of a field, and its number of bits."""
        place = list(FIELDS).index(name)
        return sum(self.widths[:place]), self.widths[place]

    @property
    def width(self) -> int:
        return sum(self.widths)


def alone(graph: Graph, addresses: int, blocks: int) -> Layout | None:
    """The layout of a word of 18 bits for a single lane, with its weight beside it.

    None where it takes more bits.
    """
    widths = {name: bits for name, (_, bits) in FIELDS.items()} | {
        "place": (2 * blocks - 1).bit_length() if blocks > 1 else 0,
        "source": addresses,
        "gather": 0,
        "together": 0,
        "relu": int(graph.rectifies),
    }
    found = Layout(tuple(widths.values()))
    return found if found.width <= WIDTH else None


@dataclass(frozen=True)
class LaneProgram(Tabled):
    """The contents of the program memory, and of the memories of the lanes.

    inputs: Samples of a frame.
    segment_width: Bits of q within a segment of the table.
    table: Words of the table.
    words: Words of the steps.
    pipeline: The pipeline for which the fields are spread over the words.
    notes: What each word stands for.
    rectifies: Whether the hardware has ReLU.
    even: Of results with ReLU; see ``Neuron``.
    blocks: Blocks of the table; see ``LineTable``. With several, steps say in which one they look
        up.
    shared: The groups from which it was assembled.
    beside: The weight that stands beside each word, where one memory holds the program, the weights
        and the table of a single lane; empty where lanes have memories of their own.
    beside_notes: What each of these weights stands for.
    rows: How many rows of the table that memory holds; a row is an intercept and a slope.
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
    shared: LaneGraph = field(kw_only=True)
    layout: Layout = field(default=Layout(), kw_only=True)
    beside: tuple[int, ...] = field(default=(), kw_only=True)
    beside_notes: tuple[str, ...] = field(default=(), kw_only=True)
    rows: int = field(default=0, kw_only=True)

    @property
    def lanes(self) -> int:
        return self.shared.lanes

    @cached_property
    def weights(self) -> tuple[tuple[int, ...], ...]:
        """For each place the weight of each lane."""
        return tuple((weight,) for weight in self.beside) or self.shared.weights

    @property
    def contents(self) -> tuple[int, ...]:
        """All words of the memory of a single lane, with zeros up to a power of two.

        A row of the table is an intercept and a slope, and any other row is a word of the program
        and the weight beside it.
        """
        half, mask = len(self.table) // 2, (1 << WIDTH) - 1
        table = zip(self.table[: self.rows], self.table[half : half + self.rows], strict=True)
        rows = self._in_order(table, zip(self.words, self.beside, strict=True), (0, 0))
        found = [word & mask for row in rows for word in row]
        return tuple(found + [0] * ((2 << self.row_bits) - len(found)))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What each word of ``contents`` stands for; the last text serves all words beyond."""
        table = ((f"intercept of segment {n}", f"slope of segment {n}") for n in range(self.rows))
        steps = zip(self.notes, self.beside_notes, strict=True)
        rows = self._in_order(table, steps, ("not used",) * 2)
        return (*(text for row in rows for text in row), "not used")

    def _in_order(self, table: Iterable[Row], steps: Iterable[Row], unused: Row) -> list[Row]:
        if self.begin:
            return [*table, *steps]
        words = list(steps)
        return [*words, *[unused] * ((1 << self.row_width) - len(words)), *table]

    @property
    def begin(self) -> int:
        """The row of the first word of the program.

        A program that is no longer than the table stands before it, so that one bit tells which of
        them is read; a longer one stands behind it, so that no row is left over.
        """
        return self.rows if len(self.words) > 1 << self.row_width else 0

    @property
    def counter_width(self) -> int:
        """Bits of the counter, which steps through the program."""
        return max(1, (self.begin + len(self.words) - 1).bit_length())

    @property
    def row_bits(self) -> int:
        """Bits of the number of a row."""
        above = self.rows and not self.begin
        return self.row_width + 1 if above else self.counter_width

    @cached_property
    def _lines(self) -> tuple[Codes, Codes]:
        """The intercepts and the slopes of the table."""
        intercepts, slopes = np.split(np.array(list(map(signed_code, self.table))), 2)
        return intercepts, slopes

    @cached_property
    def steps(self) -> list[SimpleNamespace]:
        """The steps up to the end of the frame, with ``FIELDS`` gathered from their words."""
        at, words = self.pipeline, self.words
        clocks = {name: getattr(at, clock) for name, (clock, _) in FIELDS.items()}
        found: list[SimpleNamespace] = []
        for n in range(len(words) - at.mark):
            values = {name: get(words[n + k], self.layout[name]) for name, k in clocks.items()}
            if self.beside and values["kind"] not in LOOKED_UP:
                values["place"] = n + at.beside
            found.append(SimpleNamespace(**values))
            if found[-1].end:
                break
        return found

    @property
    def addresses(self) -> int:
        """The number of words of the operand memory that the program uses."""
        return self.inputs + sum(step.store for step in self.steps)

    @cached_property
    def output_clocks(self) -> tuple[int, ...]:
        """The clock in which each output leaves, counted from the last sample."""
        return tuple(self.clock(n) for n, step in enumerate(self.steps) if step.output)

    def clock(self, step: int) -> int:
        """The clock in which a step's result is valid, counted from a frame's last sample."""
        return self.pipeline.begin + step + self.pipeline.result

    @property
    def scheduled(self) -> list[Step]:
        return self.shared.schedule(self.pipeline)

    def stored(self, samples: Codes) -> Iterator[tuple[int, bool, Codes, Codes]]:
        """Each neuron as it is stored: its number, whether it is a ReLU, its sums, their words."""
        order = [step.neuron for step in self.scheduled if step.last]
        for number, (step, sums, words) in zip(order, self.run(samples), strict=True):
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

    def run(self, samples: Codes) -> Iterator[tuple[SimpleNamespace, list[Codes], list[Codes]]]:
        """The last step of each group, the sum of each lane, and the word that it stores.

        The steps are those of the hardware; only the sum has more bits here.

        samples, shape (frames, inputs): Codes.
        """
        lanes, zero = range(self.lanes), np.zeros(len(samples), dtype=np.int64)
        first = [np.ascontiguousarray(samples[:, k]) << SAMPLE_SHIFT for k in range(self.inputs)]
        memories = [list(first) for _ in lanes]
        sums = [zero for _ in lanes]
        for step in self.steps:
            if step.gather:
                pairs = dict(reduction_steps(self.lanes)[step.gather.bit_length() - 1])
                added = [sums[pairs[j]] if j in pairs else zero for j in lanes]
            else:
                looks = step.kind in LOOKED_UP
                weights = (0,) * self.lanes if looks else self.weights[step.place]
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
        self, step: SimpleNamespace, memory: list[Codes], weight: int, zero: Codes
    ) -> Codes:
        if step.kind == Kind.ONE:
            return zero + (weight << DROPPED)
        # A step that waits may name an address that is not written yet.
        if step.kind == Kind.WORD:
            return memory[step.source] * weight if weight else zero
        word = memory[step.source]
        negative = word >> (WIDTH - 1)
        segment = ((word ^ negative) >> self.segment_width) & (self.segments - 1)
        if self.blocks > 1:
            segment += block_of(step.place, negative & 1) * self.segments
        intercepts, slopes = self._lines
        if step.kind == Kind.INTERCEPT:
            return np.asarray(intercepts[segment] * ((negative | 1) << DROPPED))
        span = 1 << self.segment_width
        return np.asarray(slopes[segment] * ((word & (span - 1)) - span // 2))


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
    pipeline: Pipeline,
    every: bool = False,
    least_addr_width: int = 0,
) -> LaneProgram:
    """The program of a graph.

    table: That of the graph's functions; None where no neuron looks anything up.
    every: Whether all of these lanes are there, even if the graph has no work for some.
    least_addr_width: The fewest bits of the address of an operand; 0 where the memory of a lane is
        apart from that of the program, however few lanes there are.
    """
    if table:
        check_words(table)
    shared = assign_to_lanes(graph, lanes, every)
    layout = None
    if least_addr_width and shared.lanes == 1:
        width = max(least_addr_width, (graph.inputs + len(shared.groups) - 1).bit_length())
        layout = alone(graph, width, table.blocks if table else 1)
    beside = bool(layout)
    layout = layout or Layout.of(shared.lanes)
    _check(shared, layout)
    steps = shared.schedule(pipeline)
    words = [0] * (len(steps) + pipeline.mark + pipeline.padding)
    addresses = {k: k for k in range(graph.inputs)} | {-1: 0}
    codes = codes_of(graph.functions)
    weights = [0] * len(words) if beside else []
    texts = ["no weight"] * len(weights)
    notes = ["fields of steps above"] * len(words)
    left = 0
    for n, step in enumerate(steps):
        term, wait = step.term, step.neuron < 0
        neuron, group = shared.graph.neurons[step.neuron], shared.groups[step.neuron]
        if step.first:
            left = len(neuron.terms)
        # What follows the terms of a group adds up the sums of lanes.
        adds = not wait and left <= 0
        operand = "sums of lanes" if adds else operand_text(shared.graph, step)
        joint = f"{neuron.name} {'=' if step.first else '+'} "
        notes[n] = operand if wait else f"{joint}{operand}{', done' * step.last}"
        if step.last:
            addresses[graph.inputs + step.neuron] = len(addresses) - 1
        opens = OWN if not group.joined else JOINED_OUTPUT if neuron.output else JOINED
        place = codes[term.function] if term.kind in LOOKED_UP else term.weight
        if beside and term.kind not in LOOKED_UP:
            weights[n + pipeline.beside] = code = shared.weights[place][0]
            if not wait:
                text = weight_text(shared.graph, step, [code])
                texts[n + pipeline.beside] = f"{neuron.name} x {text}"
            place = 0
        values = {
            "place": place,
            "source": addresses[term.source],
            "kind": int(term.kind),
            "opens": opens if step.first else NO_SUM,
            "gather": 1 << -left if adds else 0,
            "store": step.last,
            "together": step.last and group.joined,
            "relu": step.last and neuron.relu,
            "output": step.last and neuron.output,
            "end": n == len(steps) - 1,
        }
        for name, value in values.items():
            put(words, n + getattr(pipeline, FIELDS[name][0]), layout[name], value)
        left -= not wait
    return LaneProgram(
        graph.inputs,
        table.width if table else SEGMENT_WIDTH,
        _table_words(table) if table else (),
        tuple(words),
        pipeline,
        tuple(notes),
        graph.rectifies,
        graph.cut,
        graph.even,
        1 << (table.blocks - 1).bit_length() if table else 1,
        shared=shared,
        layout=layout,
        beside=tuple(weights),
        beside_notes=tuple(texts),
        rows=_rows(graph, table) if table else 0,
    )


def _rows(graph: Graph, table: LineTable) -> int:
    """The rows of a table up to the last one that a sum reaches.

    A sum beyond the last segment has the words of the last one.
    """
    whole = len(joined(graph.functions, table.width).slopes)
    if table.blocks > 1 or len(table.slopes) < whole:
        return len(table.slopes)
    return min(segments_of(table.width), (graph.reach(table) >> table.width) + 1)


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


def _check(shared: LaneGraph, layout: Layout) -> None:
    graph, most = shared.graph, (1 << FIELDS["source"][1]) - 1
    values = graph.inputs + len(graph.neurons)
    if values > most:
        raise InputError(
            f"program: got {values} words of the operand memory, {graph.inputs} samples and "
            f"{len(graph.neurons)} results, expected {most} at most"
        )
    places = 1 << layout["place"][1]
    if layout.width > WIDTH and len(shared.weights) > places:
        raise InputError(
            f"program: got {len(shared.weights)} weights of each lane, expected {places} at most; "
            "more lanes have fewer each"
        )


def operand_text(graph: Graph, step: Step) -> str:
    """The text for the operand that a step reads."""
    term = step.term
    if step.neuron < 0:
        return "wait"
    if term.kind is Kind.ONE:
        return "1"
    if term.source < graph.inputs:
        return f"sample {term.source + 1}"
    name = graph.neurons[term.source - graph.inputs].name
    before = {Kind.WORD: "", Kind.INTERCEPT: "sign of ", Kind.DISTANCE: "low bits of "}
    return f"{before[term.kind]}{name}"


def weight_text(graph: Graph, step: Step, codes: Iterable[int]) -> str:
    """The weights of a step, one for each lane, as decimal numbers."""
    term = step.term
    if term.kind in LOOKED_UP:
        return f"{'intercept' if term.kind is Kind.INTERCEPT else 'slope'} of the table"
    operand = ONE if term.kind is Kind.ONE else graph.format_of(term.source)
    unit = 2 ** coeff_frac(graph.neurons[step.neuron].result, operand)
    return " ".join(f"{code / unit:.6g}" for code in codes)
