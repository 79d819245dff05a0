"""LMS as steps of an engine, bit for bit that of ``golden.learning.gradient``, and their order.

A *sum* is what it is in an engine: products, one in each step, then half a unit, rounding and
saturation, and a word that is stored. An engine that does not learn lacks:

=========  =======================================================================================
what       how
=========  =======================================================================================
product    the coefficient is a second word without its three lowest bits, with the sign kept
places     a word is stored where the step says, not at the next address
exchange   theta stands twice; an equation reads the one copy and writes the other, and they are
           exchanged unless a new word saturated: the step is not taken then, and flagged
=========  =======================================================================================

Samples and known outputs lie where the sequencer of placements points. The steps of all equations,
one after the other, are one pass over one placement.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from golden.engine.formats import DROPPED, RESULT, WIDTH
from golden.engine.graph import LOOKED_UP, Graph, Kind, Neuron, Term, start_of
from golden.engine.schedule import Step
from golden.learning.corrected import Corrected
from golden.learning.gradient import row_weights
from golden.numbers.fixed import Fix

_WORD = Fix(WIDTH, 0)
_TABLE = {Kind.INTERCEPT: "intercept of the table", Kind.DISTANCE: "slope of the table"}


@dataclass(frozen=True)
class NamedTerm:
    """A term of an engine, with the names of words in the place of their numbers; empty for none.

    With a ``second`` word it is a product of two words, which is not in an engine that does not
    learn.
    """

    kind: Kind
    source: str
    weight: int = 0
    second: str = ""


@dataclass(frozen=True)
class Sum:
    """A sum of products.

    name: The name of its word.
    output: Whether it begins with half a unit of an output, and not of a word.
    """

    name: str
    terms: tuple[NamedTerm, ...]
    output: bool = False


def one(weight: int) -> Iterator[NamedTerm]:
    """The number one times a weight, in as many steps as the weight needs."""
    while weight:
        part = max(_WORD.low, min(_WORD.high, weight))
        yield NamedTerm(Kind.ONE, "", part)
        weight -= part


def by(source: str, weight: int) -> NamedTerm:
    """A word times a weight."""
    return NamedTerm(Kind.WORD, source, weight)


def times(source: str, second: str) -> NamedTerm:
    """A word times a second word."""
    return NamedTerm(Kind.WORD, source, second=second)


def whole(source: str, sign: int = 1) -> NamedTerm:
    """A word itself, as a term of a sum in its own format."""
    return by(source, sign << DROPPED)


def lms(taught: Corrected, constants: Sequence[Sequence[int]]) -> list[list[Sum]]:
    """The sums of the equation of each output.

    constants: The step and the leak of each output; see ``golden.learning.gradient``.
    """
    return [
        [
            *corrected(taught),
            *_network(taught, k),
            *_row(taught, k),
            Sum("step", (by("error", step),)),
            *_new_theta(taught, leak),
        ]
        for k, (step, leak) in enumerate(constants)
    ]


def corrected(taught: Corrected) -> Iterator[Sum]:
    """The sums of the corrected samples."""
    pairs = zip(taught.gains.tolist(), taught.offsets.tolist(), strict=True)
    for k, (gain, offset) in enumerate(pairs):
        yield Sum(f"gain {k}", (by(f"theta {k}", gain),))
        yield Sum(f"offset {k}", (by(f"theta {taught.sensors + k}", offset),))
        terms = whole(f"sample {k}"), times(f"gain {k}", f"sample {k}"), whole(f"offset {k}")
        yield Sum(f"z {k}", terms)


def _network(taught: Corrected, output: int) -> Iterator[Sum]:
    hidden, last = taught.networks[output].layers
    seen = [f"z {k}" for k in range(taught.sensors)] + [f"known {k}" for k in range(output)]
    for j, (row, begun) in enumerate(zip(hidden.weights, hidden.starts, strict=True)):
        terms = [by(name, weight) for name, weight in zip(seen, row, strict=True)]
        yield Sum(f"q {j}", (*one(begun >> DROPPED), *terms))
        yield Sum(f"h {j}", tuple(NamedTerm(kind, f"q {j}") for kind in LOOKED_UP))
    # An engine begins the sum of an output with what the start holds to round it.
    begun = (last.starts[0] - start_of(True)) >> DROPPED
    terms = [by(f"h {j}", weight) for j, weight in enumerate(last.weights[0])]
    yield Sum("y", (*one(begun), *terms), output=True)
    yield Sum("error", (whole(f"known {output}"), whole("y", -1)))


def _row(taught: Corrected, output: int) -> Iterator[Sum]:
    of_one, of_square = taught.slope_weights[output]
    gains, offsets = row_weights(taught)
    for j in range(len(of_square)):
        yield Sum(f"square {j}", (times(f"h {j}", f"h {j}"),))
    for k in range(taught.sensors):
        terms = [by(f"square {j}", -int(weight)) for j, weight in enumerate(of_square[:, k])]
        yield Sum(f"slope {k}", (*one(int(of_one[k])), *terms))
        yield Sum(f"by gain {k}", (times(f"slope {k}", f"sample {k}"),))
        yield Sum(f"row {k}", (by(f"by gain {k}", int(gains[k])),))
        yield Sum(f"row {taught.sensors + k}", (by(f"slope {k}", int(offsets[k])),))


def _new_theta(taught: Corrected, leak: int) -> Iterator[Sum]:
    for k in range(2 * taught.sensors):
        kept = by(f"theta {k}", (1 << DROPPED) - leak)
        yield Sum(f"new theta {k}", (kept, times("step", f"row {k}")))


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


def graph_of_sums(sums: Sequence[Sum], external: Sequence[str]) -> Graph:
    """Sums as neurons of an engine.

    external: The names of the words that are in the memory before.
    """
    names = [*external, *(one.name for one in sums)]
    number = {"": -1} | {name: n for n, name in enumerate(names)}
    neurons = []
    for one in sums:
        terms = (
            Term(t.kind, number[t.source], t.weight, second=number[t.second]) for t in one.terms
        )
        neurons.append(Neuron(one.name, RESULT, tuple(terms), output=one.output))
    return Graph(len(external), tuple(neurons))


def moved(graph: Graph, to: Mapping[int, int]) -> Iterator[Neuron]:
    """The neurons of a graph, with other numbers of values."""
    for neuron in graph.neurons:
        terms = (replace(term, source=to[term.source]) for term in neuron.terms)
        yield replace(neuron, terms=tuple(terms))


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
