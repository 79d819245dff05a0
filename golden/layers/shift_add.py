"""Shifted adds: sums of products with constants as a graph of adders, without a multiplier.

A node is an input, a constant, or a sum of two or three nodes, which may be shifted left or
subtracted. A row, which is one result of a matrix, is a node shifted left, and negated where
needed. Each node has only the low bits that somebody needs.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import add

from golden.numbers.fixed import Codes, signed_width

# For each input its least and its largest value.
Ends = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Input:
    """The input of this number."""

    number: int


@dataclass(frozen=True)
class Constant:
    """A whole number as a node of its own."""

    value: int


@dataclass(frozen=True)
class Operand:
    """A node, given by its index, shifted left; with a ``sign`` of -1 it is subtracted."""

    node: int
    shift: int = 0
    sign: int = 1


@dataclass(frozen=True)
class Sum:
    """The sum of two or three operands, of which at least one is added.

    They are in the order of their shifts, and the first is not shifted. It is cheapest to add the
    first, because its last bits then pass unchanged.
    """

    operands: tuple[Operand, ...]


Node = Input | Constant | Sum


@dataclass(frozen=True)
class Row:
    """A result: a node shifted left by ``shift``, and negated if ``minus`` is set."""

    node: int
    shift: int
    minus: bool


@dataclass(frozen=True)
class Alignment:
    """How the hardware takes an operand: ``(number >> cut) << move``, where one of both is 0."""

    cut: int
    move: int


@dataclass(frozen=True)
class Reach:
    """The range of a node: that of its exact value, and that of the error of dropped bits.

    least, most: Bounds of the exact value, over all inputs.
    below, above: Bounds of the error.
    twice_mean: Twice the mean error, if a dropped bit is 1 as often as 0.
    """

    least: int
    most: int
    below: int = 0
    above: int = 0
    twice_mean: int = 0


@dataclass(frozen=True)
class ShiftAdd:
    """A graph of shifted adds in which low bits have been dropped.

    ends: For each input its least and its largest value.
    nodes: All nodes; a sum comes after its operands.
    lows: For each node the lowest place that is kept, so that a node's number stands for itself
        times ``2**low``.
    """

    ends: Ends
    nodes: tuple[Node, ...]
    lows: tuple[int, ...]
    rows: tuple[Row, ...]

    @cached_property
    def sums(self) -> dict[int, Sum]:
        """The sums among the nodes, by their indices."""
        return {place: node for place, node in enumerate(self.nodes) if isinstance(node, Sum)}

    def steps(self, place: int) -> tuple[Alignment, ...]:
        """How the sum at index ``place`` takes the number of each operand."""
        return steps_of(self.sums[place], self.lows, self.lows[place])

    def beside(self, place: int) -> int:
        """How many last bits of the sum at index ``place`` pass beside its adder."""
        return beside(self.sums[place], self.steps(place))

    def passing(self, place: int) -> int:
        """As ``beside``, but 0 if the first operand is a constant or does not have these bits."""
        first, count = self.sums[place].operands[0].node, self.beside(place)
        there = self.widths[first] - self.steps(place)[0].cut
        return 0 if isinstance(self.nodes[first], Constant) or count > there else count

    @cached_property
    def levels(self) -> tuple[int, ...]:
        """For each node the number of adders on the longest path from an input."""
        found: list[int] = []
        for node in self.nodes:
            operands = node.operands if isinstance(node, Sum) else ()
            found.append(1 + max(found[one.node] for one in operands) if operands else 0)
        return tuple(found)

    @property
    def depth(self) -> int:
        """The number of adders on the longest path from an input to a row."""
        return max((self.levels[row.node] for row in self.rows), default=0)

    @cached_property
    def weights(self) -> tuple[tuple[int, ...], ...]:
        """For each node its exact factor of each input, and its constant at the end."""
        inputs = len(self.ends)
        found: list[tuple[int, ...]] = []
        for node in self.nodes:
            if isinstance(node, Input):
                found.append(tuple(int(k == node.number) for k in range(inputs + 1)))
            elif isinstance(node, Constant):
                found.append((0,) * inputs + (node.value,))
            else:
                found.append(weights_of(node, found))
        return tuple(found)

    @cached_property
    def reaches(self) -> tuple[Reach, ...]:
        """The range of each node."""
        found: list[Reach] = []
        for place, node in enumerate(self.nodes):
            exact = Reach(*sum_ends(self.weights[place][:-1], self.weights[place][-1], self.ends))
            if isinstance(node, Sum):
                exact = self._with_errors(exact, place, node, found)
            found.append(exact)
        return tuple(found)

    def _with_errors(self, exact: Reach, place: int, node: Sum, found: list[Reach]) -> Reach:
        below = above = twice = 0
        for one, step in zip(node.operands, self.steps(place), strict=True):
            reach, shift, sign = found[one.node], one.shift, one.sign
            dropped = ((1 << step.cut) - 1) << (self.lows[one.node] + shift)
            ends = (sign * ((reach.below << shift) - dropped), sign * (reach.above << shift))
            below, above = below + min(ends), above + max(ends)
            twice += sign * ((reach.twice_mean << shift) - dropped)
        return Reach(exact.least, exact.most, below, above, twice)

    @cached_property
    def bounds(self) -> tuple[tuple[int, int], ...]:
        """The least and the largest number that a node can hold, for each node."""
        return tuple(
            (-((-reach.least - reach.below) >> low), (reach.most + reach.above) >> low)
            for reach, low in zip(self.reaches, self.lows, strict=True)
        )

    @cached_property
    def widths(self) -> tuple[int, ...]:
        return tuple(signed_width(ends) for ends in self.bounds)

    def bits(self, place: int) -> int:
        """Bits of the adder of a sum. Low bits where only one operand has bits need none."""
        return max(0, self.widths[place] - self.beside(place))

    @property
    def adder_bits(self) -> int:
        return sum(map(self.bits, self.sums))

    def numbers(self, samples: Sequence[Codes] | Codes) -> list[Codes]:
        """The number at each node for given inputs, which are arrays or Python's integers."""
        found: list[Codes] = []
        for place, node in enumerate(self.nodes):
            if isinstance(node, Input):
                found.append(samples[node.number])
            elif isinstance(node, Constant):
                found.append(samples[0] * 0 + node.value)
            else:
                pairs = zip(node.operands, self.steps(place), strict=True)
                terms = (one.sign * (found[one.node] >> s.cut << s.move) for one, s in pairs)
                found.append(reduce(add, terms))
        return found


def steps_of(node: Sum, lows: Sequence[int], low: int) -> tuple[Alignment, ...]:
    """How a sum that keeps the places from ``low`` on takes each operand; the first never moves."""
    moves = [lows[one.node] + one.shift - low for one in node.operands]
    return tuple(Alignment(max(0, -move), max(0, move)) for move in moves)


def beside(node: Sum, steps: Sequence[Alignment]) -> int:
    """How many last bits of the first operand pass beside the adder of a sum unchanged."""
    return min(step.move for step in steps[1:]) if node.operands[0].sign > 0 else 0


def weights_of(node: Sum, known: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
    """The factors of a sum, from those of each node; see ``ShiftAdd.weights``."""
    columns = zip(*(known[one.node] for one in node.operands), strict=True)
    scales = [one.sign * (1 << one.shift) for one in node.operands]
    return tuple(sum(s * w for s, w in zip(scales, column, strict=True)) for column in columns)


def sum_ends(weights: Sequence[int], start: int, ends: Ends) -> tuple[int, int]:
    """The least and the largest value of ``start`` and the products of weights and inputs."""
    least = most = start
    for weight, (low, high) in zip(weights, ends, strict=True):
        if weight > 0:
            least, most = least + weight * low, most + weight * high
        elif weight < 0:
            least, most = least + weight * high, most + weight * low
    return least, most


def cut_back(ends: Ends, nodes: Sequence[Node], rows: Sequence[Row], least: int) -> ShiftAdd:
    """The graph without the bits that no row needs, where ``least`` is the lowest place to keep.

    Nodes that no row uses are left out.
    """
    needed: list[int | None] = [None] * len(nodes)

    def need(place: int, at: int) -> None:
        known, at = needed[place], max(0, at)
        needed[place] = at if known is None else min(known, at)

    for row in rows:
        need(row.node, least - row.shift)
    for place in range(len(nodes) - 1, -1, -1):
        node, at = nodes[place], needed[place]
        if isinstance(node, Sum) and at is not None:
            for one in node.operands:
                need(one.node, at - one.shift)
    # Inputs and constants keep all bits, because their unused bits cost no wires.
    kept = [n for n, node in enumerate(nodes) if needed[n] is not None or isinstance(node, Input)]
    lows = [(needed[n] or 0) if isinstance(node, Sum) else 0 for n, node in enumerate(nodes)]
    return renumbered(ends, nodes, lows, rows, kept)


def renumbered(
    ends: Ends, nodes: Sequence[Node], lows: Sequence[int], rows: Sequence[Row], kept: Sequence[int]
) -> ShiftAdd:
    """The graph of those nodes alone whose indices are ``kept``."""
    places = {n: place for place, n in enumerate(kept)}

    def moved(node: Node) -> Node:
        if isinstance(node, Sum):
            return Sum(tuple(Operand(places[o.node], o.shift, o.sign) for o in node.operands))
        return node

    return ShiftAdd(
        ends,
        tuple(moved(nodes[n]) for n in kept),
        tuple(lows[n] for n in kept),
        tuple(Row(places[row.node], row.shift, row.minus) for row in rows),
    )


def fused(graph: ShiftAdd) -> ShiftAdd:
    """The same rows, with sums of three operands where that saves the most bits of adders.

    A sum takes in an operand that is a sum of two and that nothing else uses. It takes in one at
    most, and none if it is taken in itself. Sums and their only users form trees, so the choice
    that saves the most is found exactly, from the leaves up. Numbers and errors at all nodes that
    remain are what they were, because a sum with one user keeps exactly the bits that this needs.
    """
    inner = _choice(graph)
    nodes: list[Node] = list(graph.nodes)
    for place, operand in inner.items():
        nodes[place] = _merged(graph, place, operand)
    gone = set(inner.values())
    kept = [place for place in range(len(nodes)) if place not in gone]
    return renumbered(graph.ends, nodes, graph.lows, graph.rows, kept)


def _merged(graph: ShiftAdd, place: int, operand: int) -> Sum:
    """The sum at ``place`` with the operands of one of its operands in place of that."""
    found: list[Operand] = []
    for one in graph.sums[place].operands:
        if one.node == operand:
            inner = graph.sums[operand].operands
            found += [Operand(o.node, o.shift + one.shift, o.sign * one.sign) for o in inner]
        else:
            found.append(one)
    return Sum(tuple(sorted(found, key=lambda one: (one.shift, one.node, one.sign))))


def _choice(graph: ShiftAdd) -> dict[int, int]:
    """For each sum that takes in an operand, that operand."""
    users: dict[int, list[int]] = defaultdict(list)
    for place, node in graph.sums.items():
        for one in node.operands:
            users[one.node].append(place)
    # The results of the block use the nodes of rows.
    for row in graph.rows:
        users[row.node] += [-1, -1]
    inner: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for place in graph.sums:
        if len(users[place]) == 1:
            (user,) = users[place]
            merged = _merged(graph, user, place)
            steps = steps_of(merged, graph.lows, graph.lows[user])
            bits = graph.widths[user] - beside(merged, steps)
            inner[user].append((place, graph.bits(user) + graph.bits(place) - bits))
    # The most that can be saved in the tree below a node, if it takes in none, and in any case.
    alone, best, chosen = [0] * len(graph.nodes), [0] * len(graph.nodes), {}
    for place in range(len(graph.nodes)):
        alone[place] = best[place] = sum(best[below] for below, _ in inner[place])
        for below, saving in inner[place]:
            total = alone[place] - best[below] + alone[below] + saving
            if total > best[place]:
                best[place], chosen[place] = total, below
    found: dict[int, int] = {}
    for place in sorted(chosen, reverse=True):
        if place not in found.values():
            found[place] = chosen[place]
    return found
