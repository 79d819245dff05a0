"""The order of an engine's steps, in which every operand is ready when it is read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from golden.engine.graph import NOTHING, Graph, Kind, Term
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


def one_by_one(
    graph: Graph, number: int, ready: Ready, now: int, gathers: int = 0, later: int = 0
) -> list[Step]:
    """A neuron's terms in the order in which their operands become ready, one in each clock.

    gathers: How many steps follow the terms, in which the sums of lanes are added.
    later: How many clocks after the first word of a product the second one is read.
    """

    def at(term: Term) -> int:
        return max(ready[term.source], ready[term.second] - later)

    terms = sorted(graph.neurons[number].terms, key=at) + [NOTHING] * gathers
    steps: list[Step] = []
    for place, term in enumerate(terms):
        steps += [WAIT] * (at(term) - now - len(steps))
        steps.append(Step(number, term, place == 0, place == len(terms) - 1))
    return steps


def schedule(
    graph: Graph,
    pipeline: Pipeline,
    gathers: Sequence[int] = (),
    later: int = 0,
    early: Ready = MappingProxyType({}),
) -> list[Step]:
    """Order all steps, neuron by neuron; a greedy choice keeps the waits short.

    Each time the candidates are the neurons whose operands are computed or on their way. The neuron
    that waits least comes next; among equals, the one with the longest path to an output. Outputs
    keep their order.

    gathers, later: Those of each neuron; see ``one_by_one``.
    early: The step from which on words can be read that are on their way when the sums begin.
    """
    pending = list(range(len(graph.neurons)))
    ready = dict.fromkeys(range(-1, graph.inputs), 0)
    ready[graph.inputs - 1] = pipeline.sample_ready
    ready |= early
    urgency = _urgency(graph)
    steps: list[Step] = []
    while pending:
        next_output = next((n for n in pending if graph.neurons[n].output), -1)
        found: dict[tuple[int, int, int], list[Step]] = {}
        for n in pending:
            neuron = graph.neurons[n]
            if neuron.output and n != next_output:
                continue
            if any(value not in ready for term in neuron.terms for value in term.values):
                continue
            own = gathers[n] if gathers else 0
            planned = one_by_one(graph, n, ready, len(steps), own, later)
            found[len(planned) - len(neuron.terms) - own, -urgency[n], n] = planned
        # A neuron comes after those whose results it reads, so there is one.
        best = min(found)
        steps += found[best]
        ready[graph.inputs + best[2]] = len(steps) - 1 + pipeline.result_ready
        pending.remove(best[2])
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
