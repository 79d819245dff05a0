"""Bit planes: how an engine without a multiplier reads the words of a neuron again and again.

Every operand is taken bit by bit, the highest first. In each pass over a neuron's words the sum is
doubled, and then the coefficient of every word whose operand has a bit in that plane is added; in
the sign's plane it is subtracted. A pass before the first one clears the sum.

Not every operand has bits in every plane, so a pass ends where the words that it needs end:

======  ==========================================  =================================
words   whose operands are                          are read in the planes
======  ==========================================  =================================
deep    earlier results, and the distance           all
wide    these, and samples                          down to a sample's lowest bit
all     these, and the number one with either sign  that of the number one
======  ==========================================  =================================
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH
from golden.engine.graph import Graph, Kind, Term
from golden.engine.schedule import Plan, Ready, Step
from golden.engine.tanh_table import ENDS

# The pass that clears the sum; it reads a neuron's first word.
CLEAR = WIDTH
SIGN = WIDTH - 1
# The planes of the number one, and of half a unit of a result and of an output.
ONE_PLANE = DROPPED
HALF_PLANE = DROPPED - 1
HALF_OUTPUT_PLANE = HALF_PLANE + OUTPUT_SHIFT
# Words that only fill time: a sample that does not count.
FILLING = Term(Kind.WORD, 0, 0)


@dataclass(frozen=True)
class Replay:
    """How many of a neuron's words each pass reads, from the first word on.

    Parameters
    ----------
    deep, wide, words : int
        1 or more, each not less than the one before.
    """

    deep: int
    wide: int
    words: int

    def length(self, plane: int) -> int:
        """The words of one pass."""
        if plane == CLEAR:
            return 1
        if plane == ONE_PLANE:
            return self.words
        return self.wide if plane >= SAMPLE_SHIFT else self.deep

    def before(self, plane: int) -> int:
        """Clocks from the first pass to that of a plane."""
        return sum(self.length(p) for p in range(plane + 1, CLEAR + 1))

    @property
    def clocks(self) -> int:
        """Clocks of all passes."""
        return self.before(-1)


def replay_of(graph: Graph, terms: Sequence[Term]) -> Replay:
    """How the words of a neuron are read, in the order of ``replayed``."""
    ranks = [_rank(term, graph) for term in terms]
    deep = max((k + 1 for k, rank in enumerate(ranks) if rank == 0), default=1)
    return Replay(deep, max(k + 1 for k, rank in enumerate(ranks) if rank < 2), len(ranks))


def replayed(graph: Graph, number: int, ready: Ready, now: int) -> Plan:
    """A neuron's words in an order that its passes allow, those that are there first in front.

    Of two orders that which takes fewer clocks: deep words before wide ones, or both by the clock
    in which their operands are there, and the lowest planes read wide ones too.
    """
    terms = graph.neurons[number].terms
    orders = [
        sorted(terms, key=lambda term: (_rank(term, graph), ready[term.source])),
        sorted(terms, key=lambda term: (_rank(term, graph) == 2, ready[term.source])),
    ]
    filled = [_filled(graph, order, ready, now) for order in orders]
    clocks = [replay_of(graph, words).clocks for words in filled]
    words = filled[clocks.index(min(clocks))]
    least = replay_of(graph, _filled(graph, orders[0], ready, max(ready.values()))).clocks
    steps = [Step(number, term, k == 0, k == len(words) - 1) for k, term in enumerate(words)]
    return Plan(tuple(steps), min(clocks) - least, now + min(clocks))


def _filled(graph: Graph, terms: list[Term], ready: Ready, now: int) -> list[Term]:
    """As many words that fill time before others as no operand is read before it is there.

    One is before those of a neuron that has nothing but the number one.
    """
    words = terms if any(_rank(term, graph) < 2 for term in terms) else [FILLING, *terms]
    while True:
        replay = replay_of(graph, words)
        used = [now + replay.before(_first_plane(term)) + k for k, term in enumerate(words)]
        if all(ready[term.source] <= clock for term, clock in zip(words, used, strict=True)):
            return words
        words = [FILLING, *words]


def _rank(term: Term, graph: Graph) -> int:
    if term.kind in (Kind.ONE, Kind.INTERCEPT):
        return 2
    return int(term.kind is Kind.WORD and term.source < graph.inputs)


def _first_plane(term: Term) -> int:
    """The first plane in which an operand's bits count."""
    return {Kind.WORD: SIGN, Kind.DISTANCE: max(ENDS) - 1}.get(term.kind, ONE_PLANE)
