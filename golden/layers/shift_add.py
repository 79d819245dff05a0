"""Shifted adds: sums of products with constants as a graph of adders, without a multiplier.

A node is an input, a constant, or the sum or difference of two nodes, one of them moved left. A
row, one result of a matrix, is a node moved left, maybe negated. Nodes below the least place that
anybody asks for are cut.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from golden.fixed import Codes, signed_width


@dataclass(frozen=True)
class Input:
    """Number ``number`` of the inputs."""

    number: int


@dataclass(frozen=True)
class Constant:
    """A whole number."""

    value: int


@dataclass(frozen=True)
class Sum:
    """``low + (high << shift)``, either of them negated but not both: two nodes by their places.

    A number is cheapest taken away as the high one: the low one's last bits then pass as they are.
    """

    low: int
    high: int
    shift: int
    low_sign: int = 1
    high_sign: int = 1


Node = Input | Constant | Sum


@dataclass(frozen=True)
class Row:
    """A result: a node moved left by ``shift``, negated where ``minus``."""

    node: int
    shift: int
    minus: bool


@dataclass(frozen=True)
class Alignment:
    """What the hardware of a sum adds: ``low >> low_cut`` and ``(high >> high_cut) << move``.

    One of ``high_cut`` and ``move`` is 0.
    """

    low_cut: int
    high_cut: int
    move: int


@dataclass(frozen=True)
class Reach:
    """What a node can be: its exact value, and by how much cutting can move it.

    Attributes
    ----------
    least, most : int
        Of the exact value, over all inputs.
    below, above : int
        The error of cutting lies between them.
    twice_mean : int
        Twice its mean when bits that are cut are as often 1 as 0.
    """

    least: int
    most: int
    below: int = 0
    above: int = 0
    twice_mean: int = 0


@dataclass(frozen=True)
class ShiftAdd:
    """A graph of shifted adds, cut.

    Parameters
    ----------
    low, high : int
        The least and the largest input.
    nodes : tuple of Node
        In an order in which a sum comes behind its operands.
    lows : tuple of int
        Of each node the least place that is kept: it stands for its number times ``2**low``.
    rows : tuple of Row
    """

    low: int
    high: int
    nodes: tuple[Node, ...]
    lows: tuple[int, ...]
    rows: tuple[Row, ...]

    @property
    def inputs(self) -> int:
        """How many there are."""
        return sum(isinstance(node, Input) for node in self.nodes)

    def step(self, place: int) -> Alignment:
        """How the sum at ``place`` is made of the numbers of its operands."""
        node = self.nodes[place]
        assert isinstance(node, Sum)
        low = self.lows[place]
        move = self.lows[node.high] + node.shift - low
        return Alignment(low - self.lows[node.low], max(0, -move), max(0, move))

    @cached_property
    def levels(self) -> tuple[int, ...]:
        """Of each node the adders on the longest way from an input."""
        found: list[int] = []
        for node in self.nodes:
            operands = (node.low, node.high) if isinstance(node, Sum) else ()
            found.append(1 + max(found[place] for place in operands) if operands else 0)
        return tuple(found)

    @property
    def depth(self) -> int:
        """Adders on the longest way to a row."""
        return max((self.levels[row.node] for row in self.rows), default=0)

    @cached_property
    def weights(self) -> tuple[tuple[int, ...], ...]:
        """Of each node the exact product with each input, and the constant last."""
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
        """What each node can be."""
        found: list[Reach] = []
        for place, node in enumerate(self.nodes):
            ends = [(w * self.low, w * self.high) for w in self.weights[place][:-1]]
            start = self.weights[place][-1]
            exact = Reach(start + sum(map(min, ends)), start + sum(map(max, ends)))
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
        """The least and the largest number that can stand at each node."""
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
        """Bits of all adders: of each, those above the places where one operand alone has bits."""
        return sum(
            max(0, self.widths[place] - (self.step(place).move if node.low_sign > 0 else 0))
            for place, node in enumerate(self.nodes)
            if isinstance(node, Sum)
        )

    def numbers(self, samples: Sequence[Codes] | Codes) -> list[Codes]:
        """What stands at each node, for the values of each input: arrays or Python's integers."""
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


def cut_back(
    low: int, high: int, nodes: Sequence[Node], rows: Sequence[Row], least: int
) -> ShiftAdd:
    """The graph with no bit that no row needs; ``least`` is the least place that is kept.

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
    # Inputs and constants stay whole: what is not needed of them is no wire.
    kept = [n for n, node in enumerate(nodes) if needed[n] is not None or isinstance(node, Input)]
    places = {n: place for place, n in enumerate(kept)}

    def moved(node: Node) -> Node:
        if isinstance(node, Sum):
            return replace(node, low=places[node.low], high=places[node.high])
        return node

    return ShiftAdd(
        low,
        high,
        tuple(moved(nodes[n]) for n in kept),
        tuple((needed[n] or 0) if isinstance(nodes[n], Sum) else 0 for n in kept),
        tuple(Row(places[row.node], row.shift, row.minus) for row in rows),
    )


def clocks_of(graph: ShiftAdd, levels: int) -> tuple[int, ...]:
    """How many registers stand before each node, with one every ``levels`` adders."""
    return tuple(max(0, -(-level // levels) - 1) for level in graph.levels)
