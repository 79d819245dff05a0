"""Shifted adds: sums of products with constants as a graph of adders, without a multiplier.

A node is an input, a constant, or the sum or difference of two nodes, one of which is shifted left.
A row, which is one result of a matrix, is a node shifted left, and negated where needed. Each node
has only the low bits that somebody needs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from golden.fixed import Codes, signed_width

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
class Sum:
    """``low + (high << shift)``; the operands are nodes' indices, and one of them may be negated.

    It is cheapest to subtract the high operand, because the last bits of the low one then pass
    unchanged.
    """

    low: int
    high: int
    shift: int
    low_sign: int = 1
    high_sign: int = 1


Node = Input | Constant | Sum


@dataclass(frozen=True)
class Row:
    """A result: a node shifted left by ``shift``, and negated if ``minus`` is set."""

    node: int
    shift: int
    minus: bool


@dataclass(frozen=True)
class Alignment:
    """The operands that the hardware adds: ``low >> low_cut`` and ``(high >> high_cut) << move``.

    At least one of ``high_cut`` and ``move`` is 0.
    """

    low_cut: int
    high_cut: int
    move: int


@dataclass(frozen=True)
class Reach:
    """The range of a node: that of its exact value, and that of the error of dropped bits.

    Attributes
    ----------
    least, most : int
        Bounds of the exact value, over all inputs.
    below, above : int
        Bounds of the error.
    twice_mean : int
        Twice the mean error, if a dropped bit is 1 as often as 0.
    """

    least: int
    most: int
    below: int = 0
    above: int = 0
    twice_mean: int = 0


@dataclass(frozen=True)
class ShiftAdd:
    """A graph of shifted adds in which low bits have been dropped.

    Parameters
    ----------
    ends : tuple of tuple of int
        For each input its least and its largest value.
    nodes : tuple of Node
        All nodes; a sum comes after its operands.
    lows : tuple of int
        For each node the lowest place that is kept, so that a node's number stands for itself times
        ``2**low``.
    rows : tuple of Row
    """

    ends: Ends
    nodes: tuple[Node, ...]
    lows: tuple[int, ...]
    rows: tuple[Row, ...]

    @property
    def inputs(self) -> int:
        """The number of inputs."""
        return len(self.ends)

    def step(self, place: int) -> Alignment:
        """How the sum at index ``place`` is formed from the numbers of its operands."""
        node = self.nodes[place]
        assert isinstance(node, Sum)
        low = self.lows[place]
        move = self.lows[node.high] + node.shift - low
        return Alignment(low - self.lows[node.low], max(0, -move), max(0, move))

    @cached_property
    def levels(self) -> tuple[int, ...]:
        """For each node the number of adders on the longest path from an input."""
        found: list[int] = []
        for node in self.nodes:
            operands = (node.low, node.high) if isinstance(node, Sum) else ()
            found.append(1 + max(found[place] for place in operands) if operands else 0)
        return tuple(found)

    @property
    def depth(self) -> int:
        """The number of adders on the longest path from an input to a row."""
        return max((self.levels[row.node] for row in self.rows), default=0)

    @cached_property
    def weights(self) -> tuple[tuple[int, ...], ...]:
        """For each node its exact factor of each input, and its constant at the end."""
        inputs = self.inputs
        found: list[tuple[int, ...]] = []
        for node in self.nodes:
            if isinstance(node, Input):
                found.append(tuple(int(k == node.number) for k in range(inputs + 1)))
            elif isinstance(node, Constant):
                found.append((0,) * inputs + (node.value,))
            else:
                pairs = zip(found[node.low], found[node.high], strict=True)
                found.append(
                    tuple(node.low_sign * a + node.high_sign * (b << node.shift) for a, b in pairs)
                )
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
        step = self.step(place)
        below = above = twice = 0
        for operand, shift, cut, sign in (
            (node.low, 0, step.low_cut, node.low_sign),
            (node.high, node.shift, step.high_cut, node.high_sign),
        ):
            reach = found[operand]
            dropped = ((1 << cut) - 1) << (self.lows[operand] + shift)
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
        """Bits of the number at each node."""
        return tuple(signed_width(ends) for ends in self.bounds)

    @property
    def adder_bits(self) -> int:
        """Bits of all adders. Low bits where only one operand has bits need no adder."""
        return sum(
            max(0, self.widths[place] - (self.step(place).move if node.low_sign > 0 else 0))
            for place, node in enumerate(self.nodes)
            if isinstance(node, Sum)
        )

    def numbers(self, samples: Sequence[Codes] | Codes) -> list[Codes]:
        """The number at each node for given inputs, which are arrays or Python's integers."""
        found: list[Codes] = []
        for place, node in enumerate(self.nodes):
            if isinstance(node, Input):
                found.append(samples[node.number])
            elif isinstance(node, Constant):
                found.append(samples[0] * 0 + node.value)
            else:
                step = self.step(place)
                low = found[node.low] >> step.low_cut
                high = (found[node.high] >> step.high_cut) << step.move
                found.append(node.low_sign * low + node.high_sign * high)
        return found


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
            need(node.low, at)
            need(node.high, at - node.shift)
    # Inputs and constants keep all bits, because their unused bits cost no wires.
    kept = [n for n, node in enumerate(nodes) if needed[n] is not None or isinstance(node, Input)]
    places = {n: place for place, n in enumerate(kept)}

    def moved(node: Node) -> Node:
        if isinstance(node, Sum):
            return replace(node, low=places[node.low], high=places[node.high])
        return node

    return ShiftAdd(
        ends,
        tuple(moved(nodes[n]) for n in kept),
        tuple((needed[n] or 0) if isinstance(nodes[n], Sum) else 0 for n in kept),
        tuple(Row(places[row.node], row.shift, row.minus) for row in rows),
    )


def clocks_of(graph: ShiftAdd, levels: int) -> tuple[int, ...]:
    """The number of registers before each node, with one after every ``levels`` adders."""
    return tuple(max(0, -(-level // levels) - 1) for level in graph.levels)
