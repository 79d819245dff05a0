"""The order of an engine's steps, so that every operand is there when it is read."""

from __future__ import annotations

from dataclasses import dataclass

from golden.engine.graph import Graph, Kind, Term
from golden.engine.pipeline import Pipeline


@dataclass(frozen=True)
class Step:
    """One clock of the program.

    Parameters
    ----------
    neuron : int
        Its number in the graph; -1 for a step that waits.
    term : Term
    first, last : bool
        Whether the neuron's sum starts or ends with it.
    """

    neuron: int
    term: Term
    first: bool = False
    last: bool = False


WAIT = Step(-1, Term(Kind.WORD, -1, 0))


def schedule(graph: Graph, pipeline: Pipeline) -> list[Step]:
    """Steps neuron by neuron, in an order that waits as little as a greedy choice finds.

    At each point the neurons whose operands are computed or on their way compete. The one that
    waits least is taken; of several, that on the longest way to an output. Outputs keep their
    order. Within a neuron the terms stand in the order in which their operands are there.
    """
    pending = list(range(len(graph.neurons)))
    ready = dict.fromkeys(range(-1, graph.inputs), 0)
    ready[graph.inputs - 1] = pipeline.sample_ready
    urgency = _urgency(graph)
    steps: list[Step] = []
    while pending:
        next_output = next((n for n in pending if graph.neurons[n].output), -1)
        best: tuple[tuple[int, int, int], list[Term]] | None = None
        for n in pending:
            neuron = graph.neurons[n]
            if neuron.output and n != next_output:
                continue
            if any(term.source not in ready for term in neuron.terms):
                continue
            terms = sorted(neuron.terms, key=lambda term: ready[term.source])
            waits = _waits(terms, ready, len(steps))
            if best is None or (waits, -urgency[n], n) < best[0]:
                best = (waits, -urgency[n], n), terms
        assert best is not None, "a neuron comes before those whose results it reads"
        n, terms = best[0][2], best[1]
        for place, term in enumerate(terms):
            steps += [WAIT] * (ready[term.source] - len(steps))
            steps.append(Step(n, term, place == 0, place == len(terms) - 1))
        ready[graph.inputs + n] = len(steps) - 1 + pipeline.result_ready
        pending.remove(n)
    return steps


def _waits(terms: list[Term], ready: dict[int, int], now: int) -> int:
    """Steps that wait, when a neuron starts now."""
    at = now
    for term in terms:
        at = max(at, ready[term.source]) + 1
    return at - now - len(terms)


def _urgency(graph: Graph) -> list[int]:
    """For each neuron the most steps on a way from it to the end."""
    following: list[list[int]] = [[] for _ in graph.neurons]
    for n, neuron in enumerate(graph.neurons):
        for term in neuron.terms:
            if term.source >= graph.inputs:
                following[term.source - graph.inputs].append(n)
    urgency = [0] * len(graph.neurons)
    for n in reversed(range(len(graph.neurons))):
        longest = max((urgency[m] for m in following[n]), default=0)
        urgency[n] = len(graph.neurons[n].terms) + longest
    return urgency
