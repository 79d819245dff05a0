"""A constant matrix as a graph of shifted adds, in which rows share common sums.

It looks for common subexpressions of two terms in canonical signed digits, as in R. I. Hartley,
Subexpression sharing in filters using canonic signed digit multipliers, IEEE Transactions on
Circuits and Systems II, 1996. The rule by which it chooses among them is ours.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import astuple, dataclass, replace
from functools import lru_cache
from random import Random
from typing import Any

from golden.layers.shift_add import (
    Constant,
    Ends,
    Input,
    Node,
    Operand,
    Row,
    ShiftAdd,
    Sum,
    cut_back,
    fused,
    sum_ends,
    weights_of,
)
from golden.numbers.fixed import signed_width
from golden.numbers.signed_digits import signed_digits

# A term of a row: a node, and the number of places by which it is shifted left.
Term = tuple[int, int]
# Two terms together: their nodes, the number of places by which the second is shifted left against
# the first, and whether their signs differ. If they do, the second is subtracted from the first.
Pattern = tuple[int, int, int, bool]
# By how many per cent chance changes the value of a pattern. Successive runs use these in turn.
SPREADS = (0, 20)
# The most runs. A large matrix gets fewer of them, so that about ``PAIRS`` pairs of digits are
# examined in all.
RUNS = 40
# One more pipeline stage is taken only if it saves more than 1 / (PAYS + 1) of the adder bits.
PAYS = 19
PAIRS = 400_000


class GraphBuilder:
    """A graph of sums that is still being extended."""

    def __init__(self, ends: Ends):
        self.ends, inputs = ends, len(ends)
        self.nodes: list[Node] = [Input(k) for k in range(inputs)]
        self.levels = [0] * inputs
        self.widths = [signed_width(pair) for pair in ends]
        # For each node its factors of all inputs, and its constant at the end.
        self._weights = [tuple(int(j == k) for j in range(inputs + 1)) for k in range(inputs)]

    def constant(self, value: int) -> int:
        """Append a constant; returns its index among the nodes."""
        return self._append(Constant(value), 0, (0,) * (len(self._weights[0]) - 1) + (value,))

    def sum(self, node: Sum) -> int:
        """Append a sum; returns its index among the nodes."""
        level = 1 + max(self.levels[one.node] for one in node.operands)
        return self._append(node, level, weights_of(node, self._weights))

    def _append(self, node: Node, level: int, weights: tuple[int, ...]) -> int:
        self.nodes.append(node)
        self.levels.append(level)
        self.widths.append(signed_width(sum_ends(weights[:-1], weights[-1], self.ends)))
        self._weights.append(weights)
        return len(self.nodes) - 1

    def copy(self) -> GraphBuilder:
        """Another graph that begins with the same nodes."""
        other = GraphBuilder(self.ends)
        for name, values in vars(self).items():
            if isinstance(values, list):
                setattr(other, name, list(values))
        return other

    def overlap(self, pattern: Pattern) -> int:
        """Number of places in which both terms of a pattern have bits."""
        low, high, shift, _ = pattern
        return max(0, min(self.widths[low], self.widths[high] + shift) - shift)

    def top(self, term: Term) -> int:
        """The place just above the highest bit of a term."""
        return term[1] + self.widths[term[0]]


class SubexpressionSearch:
    """Rows of signed terms, in which patterns that occur often become terms of their own.

    All runs begin with the same rows, so these are examined once: each run works on a copy, which
    ``begun`` makes.
    """

    spread: int
    random: Random
    luck: dict[Pattern, int]
    queue: list[tuple[int, int, Pattern]]

    def __init__(self, graph: GraphBuilder, rows: list[dict[Term, int]], place: int):
        self.graph, self.rows, self.place = graph, rows, place
        # For each pattern the rows in which it occurs, each with the pattern's low term there.
        self.places: dict[Pattern, set[tuple[int, Term]]] = defaultdict(set)
        for number, row in enumerate(rows):
            for term in row:
                for pattern, low in self._pairs(number, term):
                    self.places[pattern].add((number, low))
        several = sorted(pattern for pattern, found in self.places.items() if len(found) > 1)
        self._first = [(pattern, self._saved(pattern)) for pattern in several]

    def begun(self, spread: int, random: Random) -> SubexpressionSearch:
        """A copy for one run, in which chance changes the value of a pattern by ``spread`` %."""
        other = copy(self)
        other.graph, other.rows = self.graph.copy(), [dict(row) for row in self.rows]
        other.places = defaultdict(set, {p: set(found) for p, found in self.places.items()})
        other.spread, other.random, other.luck, other.queue = spread, random, {}, []
        for pattern, saved in self._first:
            other._offer(pattern, saved)
        return other

    def _pairs(self, number: int, term: Term) -> list[tuple[Pattern, Term]]:
        """The pattern of a term with each other one of its row, and the low one of the two.

        The low one gives the sum its sign. A search spends most of its time here.
        """
        row = self.rows[number]
        node, place = term
        own = row[term]
        found: list[tuple[Pattern, Term]] = []
        for other, sign in row.items():
            shift = other[1] - place
            if shift > 0 or (shift == 0 and other[0] > node):
                found.append(((node, other[0], shift, sign != own), term))
            elif other != term:
                found.append(((other[0], node, -shift, sign != own), other))
        return found

    def _uses(self, pattern: Pattern) -> list[tuple[int, Term]]:
        """Occurrences of a pattern, of which no two share a term."""
        found: list[tuple[int, Term]] = []
        used: set[tuple[int, Term]] = set()
        for number, low in sorted(self.places[pattern]):
            ends = {(number, low), (number, (pattern[1], low[1] + pattern[2]))}
            if not ends & used:
                used |= ends
                found.append((number, low))
        return found

    def _saved(self, pattern: Pattern) -> int | None:
        """About how many bits of adders a pattern saves, or None if no two occurrences overlap.

        A shared sum has the bits of the occurrence that needs the most.
        """
        # Two occurrences can share a term only if the pattern has the same node twice.
        uses = self._uses(pattern) if pattern[0] == pattern[1] else self.places[pattern]
        overlap = self.graph.overlap(pattern)
        if len(uses) < 2 or not overlap:
            return None
        top = overlap + pattern[2] - self.place
        bits = [max(0, min(overlap, top + low[1])) for _, low in uses]
        return sum(bits) - max(bits)

    def _gain(self, pattern: Pattern, saved: int | None) -> int:
        """The bits that a pattern saves, times a random number near 100."""
        if saved is None:
            return 0
        if pattern not in self.luck:
            self.luck[pattern] = 100 + self.random.randrange(-self.spread, self.spread + 1)
        return saved * self.luck[pattern]

    def _offer(self, pattern: Pattern, saved: int | None) -> None:
        if (gain := self._gain(pattern, saved)) > 0:
            heapq.heappush(self.queue, (-gain, self.random.getrandbits(32), pattern))

    def run(self) -> None:
        """Share patterns until none occurs more than once."""
        while self.queue:
            offered, _, pattern = heapq.heappop(self.queue)
            saved = self._saved(pattern)
            if self._gain(pattern, saved) == -offered:
                self._share(pattern)
            else:
                self._offer(pattern, saved)

    def _share(self, pattern: Pattern) -> None:
        low_node, high_node, shift, differ = pattern
        pair = Operand(low_node), Operand(high_node, shift, -1 if differ else 1)
        node = self.graph.sum(Sum(pair))
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
        for new in sorted(new for new in found if len(self.places[new]) > 1):
            self._offer(new, self._saved(new))


def add_up(
    graph: GraphBuilder, terms: list[tuple[Term, int]], depth: int, place: int
) -> tuple[Term, int]:
    """Add all terms of a row, smallest first, in at most ``depth`` levels if that is possible.

    Terms of levels l can be added within d levels if the sum of their ``2**l`` is at most ``2**d``.
    Bits below ``place`` are not used, so of two terms there either may be subtracted from the
    other. The negative one is subtracted, since otherwise the row would have to be negated in the
    end. When a constant takes part, the sum is made positive too.
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
            # The sign of a constant can still be chosen freely.
            sign = 1
            low_sign, high_sign = (1, high_sign) if constants[0] else (low_sign, 1)
        operands = Operand(low[0], 0, low_sign * sign), Operand(high[0], shift, high_sign * sign)
        node = graph.sum(Sum(operands))
        terms.append(((node, low[1]), sign))
    return terms[0]


def _pair(weights: Sequence[int], room: int) -> tuple[int, int]:
    """The first two whose sum fits in the room that is left; else the two of the least weight."""
    count = len(weights)
    for second in range(1, count):
        for first in range(second):
            one, other = weights[first], weights[second]
            if 2 * max(one, other) - one - other <= room:
                return first, second
    first, second = sorted(sorted(range(count), key=lambda n: weights[n])[:2])
    return first, second


@dataclass(frozen=True)
class Wanted:
    """A constant matrix whose sums of products are wanted, and what its graph may be.

    weights: A row for each sum.
    biases: The constant of each sum.
    ends: For each input its least and its largest value.
    place: The lowest bit position of a sum that is kept.
    levels: Most adders between two registers. The graph has the least possible number of register
        stages, or one more where that saves enough.
    spare: Adders that follow the last adder of a row.
    operands: The most operands of an adder, 2 or 3. Sums of three are made of two sums that are
        chosen first, so the numbers of stages that are tried reach one further.
    runs: How many runs the search has; 0 for ``RUNS`` and ``PAIRS``.
    """

    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    ends: Ends
    place: int
    levels: int
    spare: int
    operands: int
    runs: int

    def stages(self, depth: int) -> int:
        """The register stages of so many adders one behind the other."""
        return max(1, -(-(depth + self.spare) // self.levels))


@lru_cache(maxsize=64)
def shared(wanted: Wanted) -> ShiftAdd:
    """The graph for a matrix with the fewest bits of adders among several runs."""
    digits = [
        {(k, place): sign for k, weight in enumerate(row) for place, sign in signed_digits(weight)}
        for row in wanted.weights
    ]
    pairs = sum(len(row) ** 2 for row in digits)
    at_first = SubexpressionSearch(GraphBuilder(wanted.ends), digits, wanted.place)
    # For each number of stages the graph with the fewest bits of adders, after these.
    found: dict[int, tuple[int, ShiftAdd]] = {}
    for run in range(wanted.runs or max(1, min(RUNS, PAIRS // max(1, pairs)))):
        search = at_first.begun(SPREADS[run % len(SPREADS)], Random(run))
        search.run()
        graph, rows = search.graph, search.rows
        # Levels below which the terms of some row cannot be added up; see ``add_up``.
        weights = (sum(1 << graph.levels[node] for node, _ in row) for row in rows)
        needed = max((weight - 1).bit_length() if weight else 0 for weight in weights)
        clocks, least = wanted.stages(needed), 0
        while not least or clocks < least + wanted.operands:
            depth = clocks * wanted.levels - wanted.spare
            made = finished(wanted, graph.copy(), rows, depth)
            if made.depth <= depth:
                least, before = least or clocks, wanted.stages(made.depth)
                made = fused(made) if wanted.operands > 2 else made
                taken, bits = clocks - before + wanted.stages(made.depth), made.adder_bits
                if taken not in found or bits < found[taken][0]:
                    found[taken] = bits, made
            clocks += 1
    least = min(found)
    bits, chosen = found[least]
    more_bits, more = found.get(least + 1, found[least])
    return more if more_bits * (PAYS + 1) < bits * PAYS else chosen


def finished(
    wanted: Wanted, graph: GraphBuilder, rows: Sequence[dict[Term, int]], depth: int
) -> ShiftAdd:
    """The finished graph: the terms of each row added up, low bits dropped, constants put in."""
    place = wanted.place
    results, constants = [], []
    for row, bias in zip(rows, wanted.biases, strict=True):
        needed = bool(bias or place or not row)
        if not needed:
            term, sign = add_up(graph, list(row.items()), depth, place)
            # A constant is needed to add the 1 that inverting a number leaves out.
            needed = sign < 0
        if needed:
            constants.append(graph.constant(bias >> place))
            terms = [*row.items(), ((constants[-1], place), 1)]
            term, sign = add_up(graph, terms, depth, place)
        results.append(Row(*term, sign < 0))
    nodes = list(graph.nodes)
    for constant in constants:
        nodes[constant] = Constant(1)
    made = cut_back(wanted.ends, nodes, results, place)
    values = [
        _constant(made, row, bias, place)
        for row, bias in zip(made.rows, wanted.biases, strict=True)
        if made.weights[row.node][-1]
    ]
    # These constants come in the order of the rows.
    rest = iter(values)
    return replace(
        made,
        nodes=tuple(Constant(next(rest)) if isinstance(n, Constant) else n for n in made.nodes),
    )


def _constant(graph: ShiftAdd, row: Row, bias: int, place: int) -> int:
    """The constant with which a row's mean is that of the exact sum, cut at ``place``."""
    reach = graph.reaches[row.node]
    unit = graph.weights[row.node][-1] << row.shift
    twice = 2 * bias - ((1 << place) - 1)
    if row.minus:
        # Hardware negates a number by inverting its bits, which gives one less.
        twice = -twice - (2 << (graph.lows[row.node] + row.shift))
    twice -= reach.twice_mean << row.shift
    # The quotient is rounded half up.
    return (twice + abs(unit)) // (2 * unit) if unit > 0 else -((twice + abs(unit)) // (-2 * unit))


# The search for a matrix with fewer weights takes about as long as reading what was kept.
LEAST_WEIGHTS = 32
# Takes what a graph depends on, whether it must be kept, and the search; gives the data of the
# graph. Whoever has a place for files sets it. Without it every graph is searched anew.
keeper: Callable[[dict[str, Any], bool, Callable[[], Any]], Any] | None = None


def graph_of(wanted: Wanted) -> ShiftAdd:
    """The graph of ``shared``. For a large matrix, or a given number of runs, it is found once."""
    small = sum(map(len, wanted.weights)) < LEAST_WEIGHTS
    if keeper is None or (small and not wanted.runs):
        return shared(wanted)
    # Tests set other limits, which the code does not show.
    parts = {"limits": (RUNS, PAIRS), "wanted": repr(wanted)}
    data = keeper(parts, bool(wanted.runs), lambda: as_data(shared(wanted)))
    nodes, rows = tuple(_node(*node) for node in data["nodes"]), (Row(*row) for row in data["rows"])
    return ShiftAdd(wanted.ends, nodes, tuple(data["lows"]), tuple(rows))


def as_data(graph: ShiftAdd) -> dict[str, list[Any]]:
    """A graph without its ends as data for JSON: of each node its kind and what it holds."""
    return {
        "nodes": [[type(node).__name__, *astuple(node)] for node in graph.nodes],
        "lows": list(graph.lows),
        "rows": [astuple(row) for row in graph.rows],
    }


def _node(kind: str, held: Any) -> Node:
    if kind == "Sum":
        return Sum(tuple(Operand(*one) for one in held))
    return Input(held) if kind == "Input" else Constant(held)
