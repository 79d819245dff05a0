"""A constant matrix as a graph of shifted adds that shares what its rows have in common.

Two-term common subexpressions of canonical signed digits, as in R. I. Hartley, Subexpression
sharing in filters using canonic signed digit multipliers, IEEE Transactions on Circuits and
Systems II, 1996; the choice among them is ours.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from random import Random

from golden.fixed import signed_width
from golden.layers.shift_add import Constant, Input, Node, Row, ShiftAdd, Sum, cut_back
from golden.signed_digits import signed_digits

# A term of a row: a node and the places by which it is moved left.
Term = tuple[int, int]
# Two terms as one: their nodes, the places of the second above the first, and whether their signs
# differ: then the second is taken from the first.
Pattern = tuple[int, int, int, bool]
# By how many per cent luck moves what a pattern is worth, in one run after the other.
SPREADS = (0, 20)
# Runs, the fewer the larger the matrix: about as many pairs of digits are looked at in all.
RUNS = 40
# A register more pays when it saves more than one in so many bits and itself.
PAYS = 19
PAIRS = 400_000


class Growing:
    """A graph of sums to which more are added."""

    def __init__(self, inputs: int, low: int, high: int):
        self.low, self.high = low, high
        self.nodes: list[Node] = [Input(k) for k in range(inputs)]
        self.levels = [0] * inputs
        self.widths = [signed_width((low, high))] * inputs
        # Products with the inputs, and the constant last.
        self._weights = [tuple(int(j == k) for j in range(inputs + 1)) for k in range(inputs)]

    def constant(self, value: int) -> int:
        """The place of a new constant."""
        return self._append(Constant(value), 0, (0,) * (len(self._weights[0]) - 1) + (value,))

    def sum(self, node: Sum) -> int:
        """The place of a new sum."""
        pairs = zip(self._weights[node.low], self._weights[node.high], strict=True)
        weights = tuple(node.low_sign * a + node.high_sign * (b << node.shift) for a, b in pairs)
        return self._append(node, 1 + max(self.levels[node.low], self.levels[node.high]), weights)

    def _append(self, node: Node, level: int, weights: tuple[int, ...]) -> int:
        ends = [(w * self.low, w * self.high) for w in weights[:-1]]
        bounds = (weights[-1] + sum(map(min, ends)), weights[-1] + sum(map(max, ends)))
        self.nodes.append(node)
        self.levels.append(level)
        self.widths.append(signed_width(bounds))
        self._weights.append(weights)
        return len(self.nodes) - 1

    def copy(self) -> Growing:
        """Another graph that begins as this one."""
        other = Growing(0, self.low, self.high)
        for name, values in vars(self).items():
            if isinstance(values, list):
                setattr(other, name, list(values))
        return other

    def overlap(self, pattern: Pattern) -> int:
        """Places in which both terms of a pattern have bits."""
        low, high, shift, _ = pattern
        return max(0, min(self.widths[low], self.widths[high] + shift) - shift)

    def top(self, term: Term) -> int:
        """The place above the highest bit of a term."""
        return term[1] + self.widths[term[0]]


def pattern_of(one: Term, other: Term, differ: bool) -> tuple[Pattern, Term]:
    """What two terms are together, and which of them is the low one, whose sign the sum has."""
    low, high = one, other
    # Most of the time of a search is spent here.
    if high[1] < low[1] or (high[1] == low[1] and high[0] < low[0]):
        low, high = high, low
    return (low[0], high[0], high[1] - low[1], differ), low


class Sharing:
    """Rows of terms with signs, in which patterns that occur often become terms of their own."""

    def __init__(
        self, graph: Growing, rows: list[dict[Term, int]], place: int, spread: int, random: Random
    ):
        self.graph, self.rows, self.place = graph, rows, place
        self.spread, self.random = spread, random
        self.luck: dict[Pattern, int] = {}
        # By pattern the rows and terms at which its low term stands.
        self.places: dict[Pattern, set[tuple[int, Term]]] = defaultdict(set)
        self.queue: list[tuple[int, int, Pattern]] = []
        for number, row in enumerate(rows):
            for term in row:
                for pattern, low in self._pairs(number, term):
                    self.places[pattern].add((number, low))
        for pattern in sorted(self.places):
            self._offer(pattern)

    def _pairs(self, number: int, term: Term) -> Iterator[tuple[Pattern, Term]]:
        row = self.rows[number]
        for other, sign in row.items():
            if other != term:
                yield pattern_of(term, other, sign != row[term])

    def _uses(self, pattern: Pattern) -> list[tuple[int, Term]]:
        """Places of a pattern no two of which share a term."""
        found: list[tuple[int, Term]] = []
        taken: set[tuple[int, Term]] = set()
        for number, low in sorted(self.places[pattern]):
            ends = {(number, low), (number, (pattern[1], low[1] + pattern[2]))}
            if not ends & taken:
                taken |= ends
                found.append((number, low))
        return found

    def _gain(self, pattern: Pattern) -> int:
        """Bits of adders that it saves, or about that, times a random number about 100.

        A sum that is shared has the bits of the place at which it is needed best.
        """
        # Only a node beside itself can share a term with its neighbour.
        uses = self._uses(pattern) if pattern[0] == pattern[1] else self.places[pattern]
        overlap = self.graph.overlap(pattern)
        if len(uses) < 2 or not overlap:
            return 0
        top = overlap + pattern[2] - self.place
        bits = [max(0, min(overlap, top + low[1])) for _, low in uses]
        if pattern not in self.luck:
            self.luck[pattern] = 100 + self.random.randrange(-self.spread, self.spread + 1)
        return (sum(bits) - max(bits)) * self.luck[pattern]

    def _offer(self, pattern: Pattern) -> None:
        if len(self.places[pattern]) > 1 and (gain := self._gain(pattern)) > 0:
            heapq.heappush(self.queue, (-gain, self.random.getrandbits(32), pattern))

    def run(self) -> None:
        """Share until nothing is there more than once."""
        while self.queue:
            offered, _, pattern = heapq.heappop(self.queue)
            gain = self._gain(pattern)
            if gain == -offered:
                self._share(pattern)
            elif gain > 0:
                self._offer(pattern)

    def _share(self, pattern: Pattern) -> None:
        low_node, high_node, shift, differ = pattern
        node = self.graph.sum(Sum(low_node, high_node, shift, 1, -1 if differ else 1))
        found: set[Pattern] = set()
        for number, low in self._uses(pattern):
            row = self.rows[number]
            sign = row[low]
            for term in (low, (pattern[1], low[1] + pattern[2])):
                for gone, at in self._pairs(number, term):
                    self.places[gone].discard((number, at))
                del row[term]
            term = (node, low[1])
            row[term] = sign
            for new, at in self._pairs(number, term):
                self.places[new].add((number, at))
                found.add(new)
        for new in sorted(found):
            self._offer(new)


def add_up(
    graph: Growing, terms: list[tuple[Term, int]], depth: int, place: int
) -> tuple[Term, int]:
    """One term for all of a row, the smallest first, in no more than ``depth`` levels if possible.

    Terms of levels l can be added within d levels when the sum of ``2**l`` is ``2**d`` at most.
    Bits below ``place`` are of no use, so that of two terms there either may be taken from the
    other: the negative one, or the row would have to be negated in the end. What is taken from a
    constant is positive, too.
    """
    while len(terms) > 1:
        terms.sort(key=lambda item: (graph.top(item[0]), graph.levels[item[0][0]], item))
        weights = [1 << graph.levels[term[0]] for term, _ in terms]
        first, second = _pair(weights, (1 << depth) - sum(weights))
        pair = sorted((terms[first], terms[second]), key=lambda item: (item[0][1], item[0][0]))
        (low, low_sign), (high, high_sign) = pair
        del terms[second], terms[first]
        shift = high[1] - low[1]
        free = high[1] <= place or not terms
        sign = 1 if low_sign != high_sign and free else low_sign
        constants = [isinstance(graph.nodes[term[0]], Constant) for term in (low, high)]
        if any(constants) and terms:
            # Of a constant either sign will do.
            sign = 1
            low_sign, high_sign = (1, high_sign) if constants[0] else (low_sign, 1)
        node = graph.sum(Sum(low[0], high[0], shift, low_sign * sign, high_sign * sign))
        terms.append(((node, low[1]), sign))
    return terms[0]


def _pair(weights: Sequence[int], room: int) -> tuple[int, int]:
    """The first two whose sum takes no more room than is left; else the two of the least weight."""
    count = len(weights)
    for second in range(1, count):
        for first in range(second):
            one, other = weights[first], weights[second]
            if 2 * max(one, other) - one - other <= room:
                return first, second
    first, second = sorted(sorted(range(count), key=lambda n: weights[n])[:2])
    return first, second


@dataclass(frozen=True)
class Matrix:
    """Sums of products with constants; see ``shared``.

    Attributes
    ----------
    weights : tuple of tuple of int
        A row for each sum.
    biases : tuple of int
        What each sum is added to.
    low, high : int
        The least and the largest input.
    place : int
        The least place that is kept.
    """

    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    low: int
    high: int
    place: int


@lru_cache(maxsize=64)
def shared(matrix: Matrix, levels: int, spare: int) -> ShiftAdd:
    """The graph of a matrix with the fewest bits of adders that some runs find.

    Parameters
    ----------
    matrix : Matrix
    levels : int
        Adders between registers. The graph has no more registers than it must, or one more where
        that pays.
    spare : int
        Adders that stand behind the last of a row.
    """
    digits = [
        {(k, place): sign for k, weight in enumerate(row) for place, sign in signed_digits(weight)}
        for row in matrix.weights
    ]
    pairs = sum(len(row) ** 2 for row in digits)
    found: dict[int, list[tuple[int, int, ShiftAdd]]] = defaultdict(list)
    for run in range(max(1, min(RUNS, PAIRS // max(1, pairs)))):
        graph = Growing(len(matrix.weights[0]), matrix.low, matrix.high)
        rows = [dict(row) for row in digits]
        Sharing(graph, rows, matrix.place, SPREADS[run % len(SPREADS)], Random(run)).run()
        clocks, least = max(1, -(-(least_depth(graph, rows) + spare) // levels)), 0
        while not least or clocks <= least + 1:
            depth = clocks * levels - spare
            made = finished(matrix, graph.copy(), rows, depth)
            if made.depth <= depth:
                least = least or clocks
                found[clocks].append((made.adder_bits, run, made))
            clocks += 1
    least = min(found)
    bits, _, chosen = min(found[least])
    more_bits, _, more = min(found[least + 1])
    return more if more_bits * (PAYS + 1) < bits * PAYS else chosen


def least_depth(graph: Growing, rows: Sequence[dict[Term, int]]) -> int:
    """Levels below which the terms of some row cannot be added up; see ``add_up``."""
    weights = (sum(1 << graph.levels[node] for node, _ in row) for row in rows)
    return max((weight - 1).bit_length() if weight else 0 for weight in weights)


def finished(
    matrix: Matrix, graph: Growing, rows: Sequence[dict[Term, int]], depth: int
) -> ShiftAdd:
    """The graph with all terms of each row added up, cut, and with the constants of the rows."""
    place = matrix.place
    results, constants = [], []
    for row, bias in zip(rows, matrix.biases, strict=True):
        needed = bool(bias or place or not row)
        if not needed:
            term, sign = add_up(graph, list(row.items()), depth, place)
            # What is inverted has to be corrected by 1.
            needed = sign < 0
        if needed:
            constants.append(graph.constant(bias >> place))
            terms = [*row.items(), ((constants[-1], place), 1)]
            term, sign = add_up(graph, terms, depth, place)
        results.append(Row(*term, sign < 0))
    nodes = list(graph.nodes)
    for constant in constants:
        nodes[constant] = Constant(1)
    made = cut_back(matrix.low, matrix.high, nodes, results, place)
    values = [
        _constant(made, row, bias, place)
        for row, bias in zip(made.rows, matrix.biases, strict=True)
        if made.weights[row.node][-1]
    ]
    # Those of the rows stand in their order.
    rest = iter(values)
    return replace(
        made,
        nodes=tuple(Constant(next(rest)) if isinstance(n, Constant) else n for n in made.nodes),
    )


def _constant(graph: ShiftAdd, row: Row, bias: int, place: int) -> int:
    """What a row's constant must be for its mean to be that of the exact sum, cut at ``place``."""
    reach = graph.reaches[row.node]
    unit = graph.weights[row.node][-1] << row.shift
    twice = 2 * bias - ((1 << place) - 1)
    if row.minus:
        # A number is negated by inverting its bits, which is one less.
        twice = -twice - (2 << (graph.lows[row.node] + row.shift))
    twice -= reach.twice_mean << row.shift
    # Halves up.
    return (twice + abs(unit)) // (2 * unit) if unit > 0 else -((twice + abs(unit)) // (-2 * unit))
