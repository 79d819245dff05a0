"""Bit planes: how an engine without a multiplier reads the words of a neuron again and again.

An operand enters the sum bit by bit, the highest bit first. Each pass over a neuron's words begins
by doubling the sum; then it adds the coefficient of every word whose operand has its bit of this
plane set. In the plane of the sign it subtracts the coefficient instead. A pass before the first
one clears the sum.

Not every operand has bits in every plane, so a pass ends behind the last word that it needs:

======  ==========================================  =================================
words   whose operands are                          are read in the planes
======  ==========================================  =================================
deep    earlier results, and the distance           all
wide    these, and samples                          down to a sample's lowest bit
all     these, and the number one with either sign  that of the number one
======  ==========================================  =================================
"""

from collections.abc import Sequence
from dataclasses import dataclass

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH
from golden.engine.graph import Graph, Kind, Term
from golden.engine.schedule import Plan, Ready, Step
from golden.engine.tanh_table import ENDS

# The number of the pass that clears the sum. It reads a neuron's first word.
CLEAR = WIDTH
SIGN = WIDTH - 1
# The planes of the number one, of half a unit of a result, and of half a unit of an output.
ONE_PLANE = DROPPED
HALF_PLANE = DROPPED - 1
HALF_OUTPUT_PLANE = HALF_PLANE + OUTPUT_SHIFT
# A word that only fills time: a sample with the weight 0.
FILLING = Term(Kind.WORD, 0, 0)


@dataclass(frozen=True)
class Replay:
    """How many of a neuron's words each pass reads, from the first word on.

    deep, wide, words: The number of words up to the last deep one, up to the last deep or wide one,
        and of all. Each is 1 or more, and not less than the one before.
    """

    deep: int
    wide: int
    words: int

    def length(self, plane: int) -> int:
        """The number of words in one pass."""
        if plane == CLEAR:
            return 1
        if plane == ONE_PLANE:
            return self.words
        return self.wide if plane >= SAMPLE_SHIFT else self.deep

    def before(self, plane: int) -> int:
        """Clocks from the first pass to the pass of a plane."""
        return sum(self.length(p) for p in range(plane + 1, CLEAR + 1))

    @property
    def clocks(self) -> int:
        """Clocks of all passes."""
        return self.before(-1)


def replay_of(graph: Graph, terms: Sequence[Term]) -> Replay:
    """How many words each pass reads of a neuron whose words ``replayed`` has ordered."""
    ranks = [_rank(term, graph) for term in terms]
    deep = max((k + 1 for k, rank in enumerate(ranks) if rank == 0), default=1)
    return Replay(deep, max(k + 1 for k, rank in enumerate(ranks) if rank < 2), len(ranks))


def replayed(graph: Graph, number: int, ready: Ready, now: int) -> Plan:
    """A neuron's words in an order that its passes allow, with the earliest operands first.

    Two orders are compared, and the one that takes fewer clocks is used. The first puts deep words
    before wide ones. The second sorts both together by the clock in which their operands are ready;
    then the lowest planes read wide words too.
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
    """Put so many filling words in front that no operand is read before it is ready.

    A neuron that reads nothing but the number one always gets a filling word.
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
    """The first plane in which a bit of the operand can be set."""
    return {Kind.WORD: SIGN, Kind.DISTANCE: max(ENDS) - 1}.get(term.kind, ONE_PLANE)
