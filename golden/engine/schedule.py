"""The order of an engine's steps, in which every operand is ready when it is read."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from golden.engine.graph import Graph, Kind, Term
from golden.engine.pipeline import Pipeline


@dataclass(frozen=True)
class Step:
    """One clock of the program.

    neuron: Number of the neuron in the graph; -1 for a step that waits.
    first, last: Whether this step starts or ends the neuron's sum.
    """

    neuron: int
    term: Term
    first: bool = False
    last: bool = False


WAIT = Step(-1, Term(Kind.WORD, -1, 0))


# For each value the clock from which on it can be read.
Ready = Mapping[int, int]


@dataclass(frozen=True)
class Plan:
    """The steps of a neuron, on condition that it comes next.

    waits: Clocks that the neuron takes longer than if all its operands were ready.
    end: The clock after the last step.
    """

    steps: tuple[Step, ...]
    waits: int
    end: int


def one_by_one(
    graph: Graph,
    number: int,
    ready: Ready,
    now: int,
    later: int = 0,
    early: Ready = MappingProxyType({}),
) -> Plan:
    """A neuron's terms in the order in which their operands become ready, one in each clock.

    later: How many clocks after the first word of a product the second one is read.
    early: The step from which on words can be read that are on their way when the sums begin.
    """

    def at(term: Term) -> int:
        source, second = (max(ready[value], early.get(value, 0)) for value in term.values)
        return max(source, second - later)

    terms = sorted(graph.neurons[number].terms, key=at)
    steps: list[Step] = []
    for place, term in enumerate(terms):
        steps += [WAIT] * (at(term) - now - len(steps))
        steps.append(Step(number, term, place == 0, place == len(terms) - 1))
    return Plan(tuple(steps), len(steps) - len(terms), now + len(steps))


def schedule(
    graph: Graph, pipeline: Pipeline, plan: Callable[[Graph, int, Ready, int], Plan] = one_by_one
) -> list[Step]:
    """Order all steps, neuron by neuron; a greedy choice keeps the waits short.

    Each time the candidates are the neurons whose operands are computed or on their way. The neuron
    that waits least comes next; among equals, the one with the longest path to an output. Outputs
    keep their order.
    """
    pending = list(range(len(graph.neurons)))
    ready = dict.fromkeys(range(-1, graph.inputs), 0)
    ready[graph.inputs - 1] = pipeline.sample_ready
    urgency = _urgency(graph)
    steps: list[Step] = []
    now = 0
    while pending:
        next_output = next((n for n in pending if graph.neurons[n].output), -1)
        best: tuple[tuple[int, int, int], Plan] | None = None
        for n in pending:
            neuron = graph.neurons[n]
            if neuron.output and n != next_output:
                continue
            if any(value not in ready for term in neuron.terms for value in term.values):
                continue
            planned = plan(graph, n, ready, now)
            rank = (planned.waits, -urgency[n], n)
            if best is None or rank < best[0]:
                best = rank, planned
        assert best is not None, "a neuron comes before those whose results it reads"
        n, chosen = best[0][2], best[1]
        steps += chosen.steps
        now = chosen.end
        ready[graph.inputs + n] = now - 1 + pipeline.result_ready
        pending.remove(n)
    return steps


def _urgency(graph: Graph) -> list[int]:
    """For each neuron, the number of steps on the longest path from it to the end."""
    following: list[list[int]] = [[] for _ in graph.neurons]
    for n, neuron in enumerate(graph.neurons):
        for term in neuron.terms:
            for value in term.values:
                if value >= graph.inputs:
                    following[value - graph.inputs].append(n)
    urgency = [0] * len(graph.neurons)
    for n in reversed(range(len(graph.neurons))):
        longest = max((urgency[m] for m in following[n]), default=0)
        urgency[n] = len(graph.neurons[n].terms) + longest
    return urgency
