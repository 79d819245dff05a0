"""The program of an engine that learns: frames, placements that are kept, and equations."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH, put
from golden.engine.function_table import LineTable, joined
from golden.engine.graph import Graph, Kind, start_of
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import Step, one_by_one, schedule
from golden.input_error import InputError
from golden.learning.corrected import SHORT, Corrected
from golden.learning.gradient import Pupil
from golden.learning.places import FIELDS, Places
from golden.learning.segments import Sums, corrected, lms

# The numbers of parts: equations follow from the last one on.
FRAME, KEEP, EQUATIONS = 0, 1, 2
# Delay of a jump in words: the register of the memory, one register that shortens the path to the
# counter, and the next word.
TO_JUMP = 3
# The most that a word times a second one can be.
_MOST_PRODUCT = 1 << (2 * (WIDTH - 1) - SHORT)
_TABLE = {Kind.INTERCEPT: "intercept of the table", Kind.DISTANCE: "slope of the table"}
_BEHIND = "fields of steps above"


class LessonPipeline(Pipeline):
    """That of an engine that learns, which has a table of its own and two kinds of coefficients."""

    @property
    def weight(self) -> int:
        """The word of the table is valid, and the coefficient, weight or table word, is chosen."""
        return self.operand + 2

    @property
    def start(self) -> int:
        """One clock before the product is valid, because the flag passes a register first."""
        return self.weight + 2

    @property
    def done(self) -> int:
        """The clock in which the sum is valid, four registers after weight and operand."""
        return self.weight + 4

    @property
    def run(self) -> int:
        """There is a clock more, in which the counter goes to the first step of the frame."""
        return 2


PIPELINE = LessonPipeline()
# A second word is read once its address came as a weight would.
_LATER = PIPELINE.weight - 1


@dataclass(frozen=True)
class Slot:
    """One step of a program.

    source: Address of the word that is read.
    field: The weight, or the address of the second word of a product.
    first, of_output: Whether a sum starts, and whether it is one of an output.
    store, leaves: Whether the sum is stored, and whether its word leaves the engine.
    places: Whether ``field`` is the address at which the next results are stored.
    """

    kind: Kind
    source: int
    field: int
    product: bool = False
    first: bool = False
    of_output: bool = False
    store: bool = False
    leaves: bool = False
    places: bool = False
    note: str = "wait"


@dataclass(frozen=True)
class LessonProgram:
    """The words of the program memory, and the steps of which they were made.

    taught, constants: The networks, and the step and the leak of each output.
    parts: The steps of the frame, of what keeps a placement, and of the equation of each output.
    words: Words of the table of tanh, and behind them those of the steps.
    notes: What each word stands for.
    starts: The address of the first word of the frame, of what keeps a placement, of what all
        equations begin with, and of the rest of the equation of each output.
    begun_alike: How many words all equations begin with.
    """

    taught: Corrected
    constants: tuple[tuple[int, ...], ...]
    places: Places
    table: LineTable
    parts: tuple[tuple[Slot, ...], ...]
    words: tuple[int, ...]
    notes: tuple[str, ...]
    starts: tuple[int, ...]
    begun_alike: int

    @property
    def placements(self) -> int:
        """How many placements are kept; the next one takes the place of the oldest."""
        return (1 << self.places.number_width) - 1

    def pupil(self) -> Pupil:
        """What it does with placements and theta, from a reset on."""
        return Pupil(self.taught, self.constants, self.placements)

    @property
    def lengths(self) -> tuple[int, ...]:
        return tuple(map(len, self.parts))

    @cached_property
    def output_clocks(self) -> tuple[int, ...]:
        """The clocks of a frame's results that leave, counted from the last sample."""
        steps = (n for n, slot in enumerate(self.parts[FRAME]) if slot.leaves)
        return tuple(PIPELINE.begin + n + PIPELINE.result for n in steps)

    @cached_property
    def acc_width(self) -> int:
        """Bits that hold the largest sum, whatever the words are."""
        largest, found = 0, 1
        most = {
            Kind.INTERCEPT: max(map(abs, self.table.intercepts)) << DROPPED,
            Kind.DISTANCE: max(map(abs, self.table.slopes)) << (self.table.width - 1),
        }
        for slot in (slot for part in self.parts for slot in part if not slot.places):
            product = most.get(slot.kind, abs(slot.field) << (WIDTH - 1))
            product = _MOST_PRODUCT if slot.product else product
            largest = product + (start_of(slot.of_output) if slot.first else largest)
            found = max(found, largest.bit_length() + 1)
        return found


def lesson_program(
    taught: Corrected, constants: Sequence[Sequence[int]], graph: Graph, least_addr_width: int
) -> LessonProgram:
    """The program of LMS with constant steps.

    constants: The step and the leak of each output.
    graph: The neurons of a frame, behind samples that are not corrected yet.
    least_addr_width: The least bits of an address of the operand memory.
    """
    program = lms(taught, constants)
    counts = [len(sums.neurons) - 2 * taught.sensors for sums in program]
    places = Places(
        taught.sensors,
        taught.outputs,
        max(3 * taught.sensors + len(graph.neurons), *counts),
        least_addr_width,
    )
    parts = [_frame(taught, graph, places), _keep(places)]
    parts += [_equation(sums, places) for sums in program]
    table = joined(graph.functions, taught.networks[0].segment_width)
    rates, whole = tuple(map(tuple, constants)), tuple(map(tuple, parts))
    return LessonProgram(taught, rates, places, table, whole, *assembled(table, parts))


def _frame(taught: Corrected, graph: Graph, places: Places) -> list[Slot]:
    """Theta of 0 for one bank, the corrected samples, and the networks."""
    sensors, unknowns = places.sensors, places.unknowns
    names = [f"sample {k}" for k in range(sensors)] + [f"theta {k}" for k in range(unknowns)]
    zeros = (f"theta {k} of one bank = 0" for k in range(unknowns))
    found = [_going_to(places.theta)]
    found += (Slot(Kind.ONE, 0, 0, first=True, store=True, note=note) for note in zeros)
    # The first results behind theta go to address 0.
    sums = Sums(names)
    corrected(sums, taught)
    before = sums.graph
    made = before.inputs + len(before.neurons)
    # The networks read the corrected samples, each the last of three sums.
    to = {-1: -1} | {k: before.inputs + 3 * k + 2 for k in range(sensors)}
    to |= {sensors + n: made + n for n in range(len(graph.neurons))}
    behind = (
        replace(one, terms=tuple(replace(term, source=to[term.source]) for term in one.terms))
        for one in graph.neurons
    )
    whole = Graph(before.inputs, (*before.neurons, *behind))
    early = {
        sensors + k: max(0, 1 + k + PIPELINE.result_ready - len(found)) for k in range(unknowns)
    }
    steps = schedule(whole, PIPELINE, later=_LATER, early=early)
    samples = range(places.samples, places.samples + sensors)
    theta = range(places.theta, places.theta + unknowns)
    addresses = {-1: places.samples} | dict(enumerate([*samples, *theta]))
    return [*found, *_slots(whole, steps, names, addresses, leave=True)]


def _keep(places: Places) -> list[Slot]:
    """The samples of the last frame, and the known outputs, behind each other."""
    found = [_going_to(places.placement)]
    for k in range(places.sensors):
        source, note = places.samples + k, f"placement: sample {k}, done"
        found.append(Slot(Kind.WORD, source, 1 << DROPPED, first=True, store=True, note=note))
    # A known output comes in as a sample does.
    weight = 1 << (DROPPED + OUTPUT_SHIFT - SAMPLE_SHIFT)
    for k in range(places.outputs):
        # The sum of an output begins with half a unit of one, which a known output has too.
        known = Slot(Kind.WORD, places.targets + k, weight, first=True, of_output=True)
        found.append(replace(known, store=True, note=f"placement: known {k}, done"))
    return found


def _equation(sums: Sums, places: Places) -> list[Slot]:
    """The equation of an output, and the theta that follows from it."""
    unknowns, names, neurons = places.unknowns, sums.names, sums.neurons
    graph = Graph(len(names), tuple(neurons[:-unknowns]))
    steps = schedule(graph, PIPELINE, later=_LATER)
    kept = range(places.placement, places.placement + places.sensors + places.outputs)
    theta = range(places.theta, places.theta + unknowns)
    addresses = {-1: places.samples} | dict(enumerate([*kept, *theta]))
    body = [_going_to(0), *_slots(graph, steps, names, addresses)]
    # The new theta, whose addresses are in their order.
    known = [*names, *(one.name for one in graph.neurons)]
    after = Graph(len(known), tuple(neurons[-unknowns:]))
    ready = dict.fromkeys(range(-1, after.inputs), 0) | {
        graph.inputs + step.neuron: max(0, n + PIPELINE.result_ready - len(steps))
        for n, step in enumerate(steps)
        if step.last
    }
    order: list[Step] = []
    for n in range(unknowns):
        order += one_by_one(after, n, ready, len(order), later=_LATER)
    return _placed(body, _slots(after, order, known, addresses, to=places.theta), places)


def _placed(before: list[Slot], after: list[Slot], places: Places) -> list[Slot]:
    """Two lists of steps, and a step that sends the results of the second to theta.

    The step takes effect before those of the clocks before it are stored. With enough waits between
    the lists there is a place for it.
    """
    lead = PIPELINE.mark - PIPELINE.operand
    waits = 0
    while True:
        steps = [*before, *([_waiting(places.samples)] * waits), *after]
        split = len(before) + waits
        for place in range(split, len(steps) + 1):
            if place > split and not steps[place - 1].store:
                continue
            found = [*steps[:place], _going_to(places.theta), *steps[place:]]
            stored = [n for n, slot in enumerate(found) if slot.store]
            if all((n < split) == (n < place - lead) and n != place - lead for n in stored):
                return found
        waits += 1


def _going_to(address: int) -> Slot:
    """A step between sums, which says where the next results are stored."""
    return Slot(Kind.ONE, 0, address, places=True, note=f"results go to {address}")


def _waiting(address: int) -> Slot:
    """A step that adds nothing, and reads a word that is there."""
    return Slot(Kind.WORD, address, 0)


def _slots(
    graph: Graph,
    steps: Sequence[Step],
    names: Sequence[str],
    addresses: dict[int, int],
    to: int = 0,
    leave: bool = False,
) -> list[Slot]:
    """The steps of a graph with their addresses.

    names: The names of the words that are in the memory before.
    addresses: The address of each value, to which those of the results are added; that of -1 has a
        word whenever a program runs.
    to: The address of the first result; the others follow in the order in which they are stored.
    leave: Whether outputs leave the engine.
    """
    called = {-1: "1"} | dict(enumerate([*names, *(one.name for one in graph.neurons)]))
    found = []
    for step in steps:
        if step.neuron < 0:
            found.append(_waiting(addresses[-1]))
            continue
        term, neuron = step.term, graph.neurons[step.neuron]
        product = term.second >= 0
        by = called[term.second] if product else _TABLE.get(term.kind, str(term.weight))
        if step.last:
            addresses[graph.inputs + step.neuron] = to
            to += 1
        slot = Slot(
            term.kind,
            addresses[term.source],
            addresses[term.second] if product else term.weight,
            product,
            step.first,
            step.first and neuron.output,
            step.last,
            step.last and neuron.output and leave,
            note=f"{neuron.name} {'=' if step.first else '+'} {called[term.source]} x {by}"
            f"{', done' * step.last}",
        )
        found.append(slot)
    return found


def _begun_alike(equations: Sequence[Sequence[Slot]]) -> int:
    """How many words equations can have in common: the most with which no mark meets another."""
    alike = next(
        (n for n, slots_of in enumerate(zip(*equations, strict=False)) if len(set(slots_of)) > 1),
        min(map(len, equations)) - 1,
    )

    def stores(word: int) -> bool:
        """Whether a word of an equation marks the end of a sum."""
        return word >= PIPELINE.mark and equations[0][word - PIPELINE.mark].store

    # The mark of the jump is in a word without that of a sum. Behind an equation the next one
    # begins in the middle, and two more marks count before it is known that this one has ended.
    found = [n for n in range(alike + 1) if not any(map(stores, (n - TO_JUMP, n, n + 1)))]
    if found[-1] < TO_JUMP:
        raise InputError(
            f"hardware.learning: got equations of outputs whose first {alike} steps are alike, "
            f"expected {TO_JUMP} or more, behind which the program jumps to the rest of one"
        )
    return found[-1]


def assembled(
    table: LineTable, parts: Sequence[Sequence[Slot]]
) -> tuple[tuple[int, ...], tuple[str, ...], tuple[int, ...], int]:
    """The words of some parts, and what else ``LessonProgram`` says about them, in its order."""
    alike = _begun_alike(parts[EQUATIONS:])
    shared = parts[EQUATIONS][:alike]
    pieces = [*parts[:EQUATIONS], shared, *(part[alike:] for part in parts[EQUATIONS:])]
    ((name, result),) = table.labels
    texts = zip(result.texts(table.intercepts), result.texts(table.slopes), strict=True)
    notes, starts = [f"{name} {intercept}, slope {slope}" for intercept, slope in texts], []
    for piece in pieces:
        starts.append(len(notes))
        notes += [slot.note for slot in piece]
        notes += [_BEHIND] * PIPELINE.mark * (piece is not shared)
    notes += [_BEHIND] * PIPELINE.padding
    words = [0] * len(notes)
    for n, (intercept, slope) in enumerate(zip(table.intercepts, table.slopes, strict=True)):
        put(words, n, (WIDTH, WIDTH), intercept)
        put(words, n, (0, WIDTH), slope)
    first = [*range(starts[EQUATIONS], starts[EQUATIONS] + alike)]
    put(words, first[-TO_JUMP], FIELDS["end"][1], 1)
    begins = [*starts[:EQUATIONS], *starts[EQUATIONS + 1 :]]
    for number, (part, begin) in enumerate(zip(parts, begins, strict=True)):
        rest = range(begin, begin + len(part) + PIPELINE.mark)
        _spread(words, part, [*(first if number >= EQUATIONS else ()), *rest])
    return tuple(words), tuple(notes), tuple(starts), alike


def _spread(words: list[int], part: Sequence[Slot], read: Sequence[int]) -> None:
    """Write the fields of a part's steps into the words that are read one after the other."""
    for n, slot in enumerate(part):
        values = {
            "weight": slot.field,
            "source": slot.source,
            "kind": slot.kind,
            "product": slot.product,
            "first": slot.first,
            "first_of_output": slot.of_output,
            "store": slot.store,
            "output": slot.leaves,
            "end": n == len(part) - 1,
        }
        for name, value in values.items():
            clock, field = FIELDS[name]
            put(words, read[n + getattr(PIPELINE, clock)], field, value)
        if slot.places:
            put(words, read[n + PIPELINE.operand], FIELDS["output"][1], 1)
