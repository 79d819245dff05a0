"""The program of an engine that learns: frames, placements that are kept, and equations."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import count
from typing import ClassVar

import numpy as np

from golden.engine.formats import (
    DROPPED,
    END,
    FIRST,
    FIRST_OF_OUTPUT,
    INTERCEPT,
    KIND,
    OUTPUT,
    OUTPUT_SHIFT,
    SAMPLE_SHIFT,
    SLOPE,
    SOURCE,
    STORE,
    TAKE_INTERCEPT,
    WEIGHT,
    WIDTH,
    get,
    put,
    signed_code,
    word_of,
)
from golden.engine.function_table import joined
from golden.engine.graph import Graph, Kind, start_of
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Plan, Step, one_by_one, schedule
from golden.engine.tanh_table import LineTable
from golden.learning.corrected import SHORT, Corrected
from golden.learning.places import Places
from golden.learning.segments import (
    Slot,
    Sums,
    corrected,
    going_to,
    lms,
    moved,
    slots,
    waiting,
)
from golden.numbers.fixed import Codes

# In the place of the bit for the intercept, which follows from the kind: the coefficient is a
# second word, whose address is in the field of the weight.
PRODUCT = TAKE_INTERCEPT
# The numbers of parts: equations follow from the last one on.
FRAME, KEEP, EQUATIONS = 0, 1, 2
# Delay of a jump in words: the register of the memory, one register that shortens the path to the
# counter, and the next word.
TO_JUMP = 3
# The most that a word times a second one can be.
_MOST_PRODUCT = 1 << (2 * (WIDTH - 1) - SHORT)


class LessonPipeline(Pipeline):
    """That of an engine, with a clock more in which the counter goes to the frame's first step."""

    @property
    def run(self) -> int:
        return 2


@dataclass(frozen=True)
class StoredSum:
    """A sum that is stored.

    address: Where its word goes, as the program says it.
    fits: Whether the word was not saturated.
    leaves: Whether it is an output of a frame.
    """

    address: int
    word: Codes
    fits: Codes
    leaves: bool


@dataclass(frozen=True)
class Decoded:
    """One step, with its fields gathered from the words that hold them."""

    real: bool
    places: int
    kind: int = 0
    source: int = 0
    weight: int = 0
    second: int = -1
    first: bool = False
    of_output: bool = False
    store: bool = False
    leaves: bool = False


@dataclass(frozen=True)
class LessonProgram:
    """The words of the program memory, and where each part begins.

    table, words: Words of the table of tanh, and behind them those of the steps.
    starts: The address of the first word of the frame, of what keeps a placement, of what all
        equations begin with, and of the rest of the equation of each output.
    notes: What each word stands for.
    acc_width: Bits that hold every sum, whatever is shown.
    """

    places: Places
    segment_width: int
    table: tuple[int, ...]
    words: tuple[int, ...]
    starts: tuple[int, ...]
    notes: tuple[str, ...]
    acc_width: int
    pipeline: ClassVar[Pipeline] = LessonPipeline()

    @property
    def parts(self) -> range:
        """The numbers of the parts: the frame, what keeps a placement, and an equation for each."""
        return range(len(self.starts) - 1)

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        return tuple(len(self._marks(part)) for part in self.parts)

    @cached_property
    def begun_alike(self) -> int:
        """How many words all equations begin with."""
        first = self.starts[EQUATIONS]
        # An end without a sum marks where the counter leaves what all equations begin with.
        words = ((n, self.word(first + n)) for n in count())
        return next(n for n, word in words if get(word, END) and not get(word, STORE)) + TO_JUMP

    @cached_property
    def output_steps(self) -> tuple[int, ...]:
        """The steps of a frame whose results leave."""
        marks = self._marks(FRAME)
        return tuple(n for n, word in enumerate(marks) if get(word, OUTPUT) and get(word, STORE))

    def clock(self, step: int) -> int:
        """The clock of the result of a frame's step, counted from the last sample."""
        return self.pipeline.begin + step + self.pipeline.result

    def word(self, address: int) -> int:
        """The word at an address of the program memory."""
        return self.words[address - len(self.table)]

    def _read(self, part: int, place: int) -> int:
        """The word that is read so many clocks after the first one of a part."""
        if part < EQUATIONS:
            return self.word(self.starts[part] + place)
        if place < self.begun_alike:
            return self.word(self.starts[EQUATIONS] + place)
        return self.word(self.starts[part + 1] + place - self.begun_alike)

    def _marks(self, part: int) -> list[int]:
        """The words that hold the marks of the steps of a part, up to its end."""
        found = [self._read(part, self.pipeline.mark)]
        while not (get(found[-1], END) and get(found[-1], STORE)):
            found.append(self._read(part, self.pipeline.mark + len(found)))
        return found

    def run(self, part: int, memory: Codes, bank: int, number: int) -> Iterator[StoredSum]:
        """Execute a part, sum by sum.

        part: Its number; see ``parts``.
        memory, shape (words, ...): The operand memory, of one engine or of several side by side.
            The results are written by whoever calls this.
        bank, number: The bank of theta that is read, and the number of the placement.
        """
        intercepts, slopes = self._lines
        span, place = 1 << self.segment_width, 0
        acc = np.zeros(memory.shape[1:], dtype=np.int64)

        def read(address: int) -> Codes:
            return np.asarray(memory[self.places.mapped(address, bank, number)])

        for step in self.steps[part]:
            if step.places >= 0:
                place = step.places
            if not step.real:
                continue
            if step.kind == Kind.ONE:
                product = np.full_like(acc, step.weight << DROPPED)
            elif step.kind == Kind.WORD and step.second >= 0:
                product = read(step.source) * (read(step.second) >> SHORT)
            elif step.kind == Kind.WORD:
                product = read(step.source) * step.weight
            else:
                word = read(step.source)
                sign = word >> (WIDTH - 1)
                segment = np.minimum((word ^ sign) >> self.segment_width, len(slopes) - 1)
                if step.kind == Kind.INTERCEPT:
                    product = intercepts[segment] * ((sign | 1) << DROPPED)
                else:
                    product = slopes[segment] * ((word & (span - 1)) - span // 2)
            acc = product + (start_of(step.of_output) if step.first else acc)
            if step.store:
                found = word_of(acc, 0)
                fits = np.asarray(found == acc >> DROPPED)
                yield StoredSum(place, found, fits, step.leaves)
                place = self._after(place)

    @cached_property
    def steps(self) -> list[list[Decoded]]:
        return [list(self._decoded(part)) for part in self.parts]

    def _decoded(self, part: int) -> Iterator[Decoded]:
        at = self.pipeline
        # Before the first step, words only say where results go.
        for here in range(-at.mark, self.lengths[part]):
            marks = self._read(part, here + at.mark)
            places = get(marks, OUTPUT) and not get(marks, STORE)
            where = get(marks, WEIGHT) if places else -1
            if here < 0:
                yield Decoded(real=False, places=where)
                continue
            near, begins = self._read(part, here + at.operand), self._read(part, here + at.start)
            field = get(near, WEIGHT)
            yield Decoded(
                real=True,
                places=where,
                kind=get(near, KIND),
                source=get(self._read(part, here), SOURCE),
                weight=signed_code(field),
                second=field if get(near, PRODUCT) else -1,
                first=bool(get(begins, FIRST)),
                of_output=bool(get(begins, FIRST_OF_OUTPUT)),
                store=bool(get(marks, STORE)),
                leaves=bool(get(marks, OUTPUT) and get(marks, STORE)),
            )

    def _after(self, address: int) -> int:
        """Where the next result goes."""
        half = self.places.placement
        return address & half | (address + 1) % half

    @cached_property
    def _lines(self) -> tuple[Codes, Codes]:
        table = np.array(self.table)
        return signed_code(get(table, INTERCEPT)), signed_code(get(table, SLOPE))


def lesson_program(
    taught: Corrected, constants: Sequence[Sequence[int]], graph: Graph, least_addr_width: int
) -> LessonProgram:
    """The program of LMS with constant steps.

    constants: The step and the leak of each output.
    graph: The neurons of a frame, behind samples that are not corrected yet.
    least_addr_width: The least bits of an address of the operand memory.
    """
    parts = _Parts(taught, graph)
    program = lms(taught, constants)
    counts = [len(sums.neurons) - 2 * taught.sensors for sums in program]
    places = Places(
        taught.sensors,
        taught.outputs,
        max(3 * taught.sensors + len(graph.neurons), *counts),
        least_addr_width,
    )
    found = [parts.frame(places), parts.keep(places)]
    found += [parts.equation(places, sums) for sums in program]
    width = taught.networks[0].segment_width
    table = joined(graph.functions, width)
    bits = max(_bits(part, table) for part in found)
    return _assembled(places, table, found, bits)


@dataclass(frozen=True)
class _Parts:
    """Makes the parts of a program."""

    taught: Corrected
    graph: Graph
    pipeline: ClassVar[Pipeline] = LessonPipeline()

    def frame(self, places: Places) -> list[Slot]:
        """Theta of 0 for one bank, the corrected samples, and the networks."""
        sensors, unknowns = self.taught.sensors, places.unknowns
        names = [f"sample {k}" for k in range(sensors)] + [f"theta {k}" for k in range(unknowns)]
        zeros = (f"theta {k} of one bank = 0" for k in range(unknowns))
        found = [
            going_to(places.theta),
            *(Slot(Kind.ONE, 0, 0, first=True, store=True, note=note) for note in zeros),
        ]
        # The first results behind theta go to address 0.
        sums = Sums(names)
        corrected(sums, self.taught)
        before = sums.graph
        made = before.inputs + len(before.neurons)
        to = {-1: -1} | {k: before.inputs + 3 * k + 2 for k in range(sensors)}
        to |= {sensors + n: made + n for n in range(len(self.graph.neurons))}
        graph = Graph(before.inputs, (*before.neurons, *moved(self.graph, to)))
        early = {
            sensors + k: 1 + k + self.pipeline.result_ready - len(found) for k in range(unknowns)
        }
        done = schedule(graph, self.pipeline, self._plan(early))
        addresses = self._external(places, names) | _results(graph, done)
        return [*found, *slots(graph, done, names, addresses, leave=True)]

    def keep(self, places: Places) -> list[Slot]:
        """The samples of the last frame, and the known outputs, behind each other."""
        found = [going_to(places.placement)]
        for k in range(self.taught.sensors):
            source, note = places.samples + k, f"placement: sample {k}, done"
            found.append(Slot(Kind.WORD, source, 1 << DROPPED, first=True, store=True, note=note))
        # A known output comes in as a sample does.
        weight = 1 << (DROPPED + OUTPUT_SHIFT - SAMPLE_SHIFT)
        for k in range(self.taught.outputs):
            # The sum of an output begins with half a unit of one, which a known output has too.
            known = Slot(Kind.WORD, places.targets + k, weight, first=True, of_output=True)
            found.append(replace(known, store=True, note=f"placement: known {k}, done"))
        return found

    def equation(self, places: Places, sums: Sums) -> list[Slot]:
        """The equation of an output, and the theta that follows from it."""
        unknowns, names, neurons = places.unknowns, sums.names, sums.graph.neurons
        graph = Graph(len(names), neurons[:-unknowns])
        done = schedule(graph, self.pipeline, self._plan({}))
        addresses = self._external(places, names, kept=True) | _results(graph, done)
        body = [going_to(0), *slots(graph, done, names, addresses)]
        # The new theta, whose addresses are in their order.
        known = [*names, *(one.name for one in graph.neurons)]
        early = {
            graph.inputs + step.neuron: n + self.pipeline.result_ready - len(done)
            for n, step in enumerate(done)
            if step.last
        }
        after = Graph(len(known), neurons[-unknowns:])
        order: list[Step] = []
        for n in range(unknowns):
            ready = dict.fromkeys(range(-1, after.inputs), 0)
            order += self._plan(early)(after, n, ready, len(order)).steps
        last = slots(after, order, known, addresses)
        return self._placed(body, list(last), places)

    def _plan(self, early: Mapping[int, int]) -> Callable[..., Plan]:
        """Puts terms in order. A second word is read once its address came as a weight would."""
        return partial(one_by_one, later=self.pipeline.weight - 1, early=early)

    def _placed(self, before: list[Slot], after: list[Slot], places: Places) -> list[Slot]:
        """Two lists of steps, and a step that sends the results of the second to theta.

        The step takes effect before those of the clocks before it are stored.
        """
        lead = self.pipeline.mark - self.pipeline.operand
        for waits in range(lead + 2):
            steps_of = [*before, *([waiting(places.samples)] * waits), *after]
            split = len(before) + waits
            for place in range(split, len(steps_of) + 1):
                if place > split and not steps_of[place - 1].store:
                    continue
                found = [*steps_of[:place], going_to(places.theta), *steps_of[place:]]
                effect = place - lead
                stored = [n for n, slot in enumerate(found) if slot.store]
                mine = [n for n in stored if n < split]
                if all(n < effect for n in mine) and all(n > effect for n in stored[len(mine) :]):
                    return found
        raise AssertionError("with enough waits there is always a place")

    def _external(self, places: Places, names: Sequence[str], kept: bool = False) -> dict[int, int]:
        """The addresses of words that are there before."""
        known = places.placement + self.taught.sensors if kept else places.targets
        bases = {
            "sample": places.placement if kept else places.samples,
            "known": known,
            "theta": places.theta,
        }
        found = {-1: places.samples}
        for number, name in enumerate(names):
            what, k = name.split()
            found[number] = bases[what] + int(k)
        return found


def _results(graph: Graph, done: Sequence[Step]) -> dict[int, int]:
    """The address of each result: they are stored one after the other."""
    last = [graph.inputs + step.neuron for step in done if step.last]
    return {value: n for n, value in enumerate(last)}


def _bits(part: Sequence[Slot], table: LineTable) -> int:
    """The bits of the largest sum of a part, whatever the words are."""
    largest, found = 0, 1
    most = {
        Kind.INTERCEPT: max(map(abs, table.intercepts)) << DROPPED,
        Kind.DISTANCE: max(map(abs, table.slopes)) << (table.width - 1),
    }
    for slot in part:
        if slot.places:
            continue
        product = most.get(slot.kind, abs(slot.field) << (WIDTH - 1))
        product = _MOST_PRODUCT if slot.product else product
        largest = product + (start_of(slot.of_output) if slot.first else largest)
        found = max(found, largest.bit_length() + 1)
    return found


def _begun_alike(equations: Sequence[Sequence[Slot]]) -> int:
    """How many words equations can have in common: the most with which no mark meets another."""
    alike = next(
        (n for n, slots_of in enumerate(zip(*equations, strict=False)) if len(set(slots_of)) > 1),
        min(map(len, equations)) - 1,
    )
    at = LessonPipeline()

    def stores(word: int) -> bool:
        """Whether a word of an equation marks the end of a sum."""
        return word >= at.mark and equations[0][word - at.mark].store

    # The mark of the jump is in a word without that of a sum. Behind an equation the next one
    # begins in the middle, and two more marks count before it is known that this one has ended.
    return max(n for n in range(alike + 1) if not any(map(stores, (n - TO_JUMP, n, n + 1))))


def _assembled(
    places: Places, table: LineTable, parts: Sequence[Sequence[Slot]], bits: int
) -> LessonProgram:
    at = LessonPipeline()
    behind = ["fields of steps above"] * at.mark
    alike = _begun_alike(parts[EQUATIONS:])
    assert alike >= TO_JUMP, "the first words of an equation mark no sum"
    words: list[int] = []
    notes: list[str] = []
    starts: list[int] = []

    def begin(told: Sequence[str]) -> int:
        first = len(words)
        starts.append(len(table_words(table)) + first)
        words.extend([0] * len(told))
        notes.extend(told)
        return first

    for part in parts[:EQUATIONS]:
        first = begin([*(slot.note for slot in part), *behind])
        _spread(words, part, range(first, len(words)))
    shared = range(begin([slot.note for slot in parts[EQUATIONS][:alike]]), len(words))
    put(words, shared[-TO_JUMP], END, 1)
    for part in parts[EQUATIONS:]:
        first = begin([*(slot.note for slot in part[alike:]), *behind])
        _spread(words, part, [*shared, *range(first, len(words))])
    words += [0] * at.padding
    notes += ["fields of steps above"] * at.padding
    return LessonProgram(
        places,
        table.width,
        table_words(table),
        tuple(words),
        tuple(starts),
        (*table_notes(table), *notes),
        bits,
    )


def _spread(words: list[int], part: Sequence[Slot], read: Sequence[int]) -> None:
    """Write the fields of a part's steps into the words that are read one after the other."""
    at = LessonPipeline()
    for n, slot in enumerate(part):
        put(words, read[n], SOURCE, slot.source)
        put(words, read[n + at.operand], KIND, int(slot.kind))
        put(words, read[n + at.operand], WEIGHT, slot.field)
        put(words, read[n + at.operand], PRODUCT, slot.product)
        put(words, read[n + at.start], FIRST, slot.first)
        put(words, read[n + at.start], FIRST_OF_OUTPUT, slot.of_output)
        put(words, read[n + at.mark], STORE, slot.store)
        put(words, read[n + at.mark], OUTPUT, slot.leaves)
        put(words, read[n + at.mark], END, n == len(part) - 1)
        if slot.places:
            put(words, read[n + at.operand], OUTPUT, 1)


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
