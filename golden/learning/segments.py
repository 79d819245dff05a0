"""The parts of a program that learns: sums, in an order in which their words are there in time."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from golden.engine.formats import DROPPED, RESULT
from golden.engine.graph import Graph, Kind, Neuron, Term, start_of
from golden.engine.pipeline import Pipeline
from golden.engine.schedule import WAIT, Plan, Ready, Step, schedule
from golden.learning import steps

_TABLE = {Kind.INTERCEPT: "intercept of the table", Kind.DISTANCE: "slope of the table"}


@dataclass(frozen=True)
class Slot:
    """One step of a program, with addresses in the place of numbers of values.

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


def waiting(address: int) -> Slot:
    """A step that adds nothing, and reads a word that is there."""
    return Slot(Kind.WORD, address, 0)


def going_to(address: int) -> Slot:
    """A step between sums, which says where the next results are stored."""
    return Slot(Kind.ONE, 0, address, places=True, note=f"results go to {address}")


def graph_of_sums(sums: Sequence[steps.Sum], external: Sequence[str]) -> Graph:
    """Sums as neurons of an engine.

    external: The names of the words that are in the memory before.
    """
    number = {name: n for n, name in enumerate([*external, *(one.name for one in sums)])}
    return Graph(len(external), tuple(_neuron(one, number) for one in sums))


def _neuron(one: steps.Sum, number: Mapping[str, int]) -> Neuron:
    terms: list[Term] = []
    ones = 0
    for term in one.terms:
        source = number.get(term.source, -1)
        if term.kind is steps.Kind.LOOK_UP:
            kind = Kind.DISTANCE if terms else Kind.INTERCEPT
            terms.append(Term(kind, source, 0))
        elif term.kind is steps.Kind.ONE:
            ones += term.weight
        else:
            terms.append(Term(Kind.WORD, source, term.weight, second=number.get(term.second, -1)))
    # What an engine's sum of an output begins with is taken out of its bias.
    ones -= 0 if one.rounded else start_of(True) >> DROPPED
    biases = [Term(Kind.ONE, -1, term.weight) for term in steps.one(ones)]
    return Neuron(one.name, RESULT, tuple(biases + terms), output=not one.rounded)


def moved(graph: Graph, to: Mapping[int, int]) -> Iterator[Neuron]:
    """The neurons of a graph, with other numbers of values."""
    for neuron in graph.neurons:
        terms = (replace(term, source=to[term.source]) for term in neuron.terms)
        yield replace(neuron, terms=tuple(terms))


@dataclass(frozen=True)
class Planner:
    """Puts steps in order, for products of two words too.

    early: The step from which on words can be read that are on their way when the sums begin.
    """

    pipeline: Pipeline
    early: Mapping[int, int]

    def steps(self, graph: Graph) -> list[Step]:
        """The steps of a graph."""
        return schedule(graph, self.pipeline, self.plan)

    def plan(self, graph: Graph, number: int, ready: Ready, now: int) -> Plan:
        """A neuron's terms in the order in which their operands become ready."""
        # The second word of a product is read when its address has come as a weight would.
        later = self.pipeline.weight - 1

        def at(term: Term) -> int:
            words = (max(ready[v], self.early.get(v, 0)) for v in term.values)
            source, second = words
            return max(source, second - later)

        terms = sorted(graph.neurons[number].terms, key=at)
        found: list[Step] = []
        for place, term in enumerate(terms):
            found += [WAIT] * (at(term) - now - len(found))
            found.append(Step(number, term, place == 0, place == len(terms) - 1))
        return Plan(tuple(found), len(found) - len(terms), now + len(found))

    def ready(self, graph: Graph, done: Sequence[Step]) -> dict[int, int]:
        """The step from which on each value can be read."""
        found = dict.fromkeys(range(-1, graph.inputs), 0)
        for n, step in enumerate(done):
            if step.last:
                found[graph.inputs + step.neuron] = n + self.pipeline.result_ready
        return found


def slots(
    graph: Graph,
    done: Iterable[Step],
    names: Sequence[str],
    addresses: Mapping[int, int],
    leave: bool = False,
) -> Iterator[Slot]:
    """The steps of a graph with their addresses.

    names: The names of the words that are in the memory before.
    addresses: The address of each value; that of -1 has a word whenever a program runs.
    leave: Whether outputs leave the engine.
    """
    called = {-1: "1"} | dict(enumerate([*names, *(one.name for one in graph.neurons)]))
    for step in done:
        if step.neuron < 0:
            yield waiting(addresses[-1])
            continue
        term, neuron = step.term, graph.neurons[step.neuron]
        product = term.second >= 0
        by = called[term.second] if product else _TABLE.get(term.kind, str(term.weight))
        yield Slot(
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
