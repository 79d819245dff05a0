"""constant_matrix: all sums of a layer as one graph of shifts and adds, without a multiplier."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from myhdl import Signal, always, always_comb, block, concat, intbv, modbv

from golden.layers.constant_matrix import ConstantMatrix, Finish
from golden.layers.shift_add import Alignment, Constant, Input, Row, Sum
from hdl.common import ops
from hdl.common.delay import delay

# All steps of a sum stand in one process, in variables that are wide enough for each step: with a
# process for each step, simulators take several times as long. The sum is inverted twice, which
# costs nothing and changes nothing. Otherwise Yosys would merge it and the sum that uses it into a
# carry-save adder, which takes a third more LUTs. Yosys does not do so where bits pass beside the
# adder.
#
# Three operands are added one behind the other, with nothing between, so that a tool for LUTs of
# six inputs makes one adder of them.


def wrapping(width: int):
    """A signed signal that may wrap between deltas of a simulation, but never at a clock edge."""
    half = 1 << (width - 1)
    return Signal(modbv(0, min=-half, max=half))


@block
def add(low, high, total, *, label: str, steps: tuple[Alignment, ...], minus: bool, reverse: bool):
    """The sum of two numbers, or their difference, or with ``reverse`` its negative.

    Each of them is cut first: it loses its last bits. Then ``high`` is moved left. ``label`` stands
    in the exported files.
    """
    low_cut, high_cut, move = steps[0].cut, steps[1].cut, steps[1].move
    # Where low is positive and high negative, bits of low would pass beside the adder, if high were
    # moved.
    moves = reverse or not minus
    count = len(total)
    half = 1 << max(len(low), len(high) + move, count)

    @always_comb
    def join():
        one = intbv(0, min=-half, max=half)
        other = intbv(0, min=-half, max=half)
        result = intbv(0, min=-half, max=half)
        turned = intbv(0, min=-half, max=half)
        one[:] = low >> low_cut
        other[:] = high >> high_cut
        if moves:
            other[:] = other << move
        if not minus:
            turned[:] = one + other
        else:
            turned[:] = other - one if reverse else one - other
        turned[:] = ~turned
        result[:] = ~turned
        total.next = result[count:].signed()

    return join


@block
def add_above(low, high, total, *, low_cut: int, move: int, minus: bool):
    """``low`` plus or minus ``high``, where ``high`` is moved beyond the last bits of ``low``.

    So these bits of ``low`` are the last bits of the result, and pass beside the adder.
    """
    end, start, count = low_cut, low_cut + move, len(total) - move
    half = 1 << max(len(low), len(high), count)

    @always_comb
    def join():
        one = intbv(0, min=-half, max=half)
        result = intbv(0, min=-half, max=half)
        one[:] = low >> start
        result[:] = one - high if minus else one + high
        total.next = concat(result[count:], low[start:end]).signed()

    return join


@block
def add_constant(number, total, *, value: int, cut: int, move: int, minus: bool):
    """A constant plus or minus a number, which is cut and then moved left."""
    count = len(total)
    half = 1 << max(len(number) + move, count, abs(value).bit_length() + 1)
    # A number is negated by inverting it and adding 1.
    start = value + 1 if minus else value

    @always_comb
    def join():
        one = intbv(0, min=-half, max=half)
        result = intbv(0, min=-half, max=half)
        turned = intbv(0, min=-half, max=half)
        one[:] = number >> cut
        one[:] = one << move
        if minus:
            one[:] = ~one
        turned[:] = start + one
        turned[:] = ~turned
        result[:] = ~turned
        total.next = result[count:].signed()

    return join


@block
def add_three(first, second, third, total, *, steps: tuple[Alignment, ...], minus: int):
    """The sum of three numbers, of which the last ``minus`` are subtracted, at most two.

    Each of them is cut and then moved left.
    """
    cut_1, cut_2, cut_3 = (step.cut for step in steps)
    move_1, move_2, move_3 = (step.move for step in steps)
    count = len(total)
    pairs = zip((first, second, third), steps, strict=True)
    half = 2 << max(count, *(len(number) + step.move for number, step in pairs))

    @always_comb
    def join():
        one = intbv(0, min=-half, max=half)
        other = intbv(0, min=-half, max=half)
        more = intbv(0, min=-half, max=half)
        result = intbv(0, min=-half, max=half)
        turned = intbv(0, min=-half, max=half)
        one[:] = first >> cut_1
        one[:] = one << move_1
        other[:] = second >> cut_2
        other[:] = other << move_2
        more[:] = third >> cut_3
        more[:] = more << move_3
        turned[:] = one - other if minus == 2 else one + other
        turned[:] = turned - more if minus else turned + more
        turned[:] = ~turned
        result[:] = ~turned
        total.next = result[count:].signed()

    return join


@block
def add_two_and_constant(
    first, second, total, *, value: int, steps: tuple[Alignment, ...], minus: int
):
    """A constant and two numbers, of which the last ``minus`` are subtracted; see ``add_three``."""
    cut_1, cut_2 = (step.cut for step in steps)
    move_1, move_2 = (step.move for step in steps)
    count = len(total)
    pairs = zip((first, second), steps, strict=True)
    bits = max(count, *(len(number) + step.move for number, step in pairs))
    half = 2 << max(bits, abs(value).bit_length() + 1)
    # The negative of a number is its inverse plus 1. So if both are subtracted, the sum of all
    # three negatives less 1 is inverted once.
    start = -value - 1 if minus == 2 else value

    @always_comb
    def join():
        one = intbv(0, min=-half, max=half)
        other = intbv(0, min=-half, max=half)
        result = intbv(0, min=-half, max=half)
        turned = intbv(0, min=-half, max=half)
        one[:] = first >> cut_1
        one[:] = one << move_1
        other[:] = second >> cut_2
        other[:] = other << move_2
        turned[:] = start + one
        turned[:] = turned - other if minus == 1 else turned + other
        if minus != 2:
            turned[:] = ~turned
        result[:] = ~turned
        total.next = result[count:].signed()

    return join


@block
def append(number, above, total, *, start: int, end: int):
    """``total`` is ``above``, and behind it the bits of ``number`` from ``start`` to ``end``."""

    @always_comb
    def join():
        total.next = concat(above, number[end:start]).signed()

    return join


@block
def finish(clk, number, result, *, label: str, drop: int, rectified: bool):
    """The result of a row, one clock later: its number without the last bits, saturated.

    A ``drop`` below 0 moves the number left instead. If ``rectified``, a number below 0 gives 0.
    """
    cut, move = max(0, drop), max(0, -drop)
    count, sign = len(result), max(len(number) + move, len(result))
    places = count - 1
    half = 1 << sign
    high, low = (1 << places) - 1, -(1 << places)
    fits = len(number) - drop <= count

    @always(clk.posedge)
    def keep():
        word = intbv(0, min=-half, max=half)
        if not fits:
            top = intbv(0, min=-half, max=half)
        word[:] = number >> cut
        word[:] = word << move
        if not fits:
            top[:] = word >> places
        if rectified and word[sign]:
            result.next = 0
        elif fits or top == 0 or (not rectified and top == -1):
            result.next = word[count:].signed()
        elif not rectified and word[sign]:
            result.next = low
        else:
            result.next = high

    return keep


@block
def tie_to_even(number, evened, *, drop: int):
    """``evened`` is a number whose bit ``drop`` is 0 if all bits below it are."""
    half = 1 << len(number)

    @always_comb
    def clear():
        word = intbv(0, min=-half, max=half)
        word[:] = number
        if drop == 0:
            word[0] = 0
        elif number[drop:] == 0:
            word[drop] = 0
        evened.next = word[len(number) :].signed()

    return clear


@block
def constant(clk, number, *, value: int):
    """A constant; it stands in a register, so that it has a driver."""

    @always(clk.posedge)
    def hold():
        number.next = value

    return hold


@dataclass(frozen=True)
class Term:
    """A signal that is an operand of a sum, how the sum takes it, and its sign."""

    number: Any
    step: Alignment
    sign: int

    def without(self, bits: int) -> Term:
        """The same without so many last bits of what the sum takes."""
        move = self.step.move - bits
        return replace(self, step=Alignment(self.step.cut + max(0, -move), max(0, move)))


class Numbers:
    """The number at each node of the graph in any clock, and the hardware that brings it there."""

    def __init__(self, clk, in_data, spec: ConstantMatrix):
        self.clk, self.spec, self.graph, self.clocks = clk, spec, spec.graph, spec.clocks
        # Blocks that are still to be made: MyHDL wants them made inside a block.
        self.parts: list[Callable] = []
        # The signals of the numbers, by node and clock.
        self._there = {}
        for place, node in enumerate(self.graph.nodes):
            if isinstance(node, Input):
                # MyHDL refuses a port that nothing reads.
                in_data[node.number].read = True
                self._there[place, 0] = in_data[node.number]
            elif isinstance(node, Sum):
                total = wrapping(self.graph.widths[place])
                self._sum(place, node, total)
                self._there[place, self.clocks[place]] = total

    def at(self, place: int, clock: int):
        """The number at a node, in the clock in which it is made or a later one."""
        if (place, clock) not in self._there:
            before = self.at(place, clock - 1)
            late = wrapping(len(before))
            self.parts.append(partial(delay, self.clk, None, before, late, clocks=1))
            self._there[place, clock] = late
        return self._there[place, clock]

    def _sum(self, place: int, node: Sum, total) -> None:
        """Make the number at a sum."""
        clock, passing = self.clocks[place], self.graph.passing(place)
        terms, value = [], 0
        for one, step in zip(node.operands, self.graph.steps(place), strict=True):
            known = self.graph.nodes[one.node]
            if isinstance(known, Constant):
                value += one.sign * (known.value >> step.cut << step.move)
            else:
                terms.append(Term(self.at(one.node, clock), step, one.sign))
        if len(node.operands) > 2:
            self._three(terms, value, passing, total)
            return
        steps = [term.step for term in terms]
        make: Callable
        if len(terms) < 2:
            cut, move, minus = steps[0].cut, steps[0].move, terms[0].sign < 0
            make = partial(add_constant, value=value, cut=cut, move=move, minus=minus)
        elif passing:
            minus = terms[0].sign != terms[1].sign
            make = partial(add_above, low_cut=steps[0].cut, move=steps[1].move, minus=minus)
        else:
            minus = terms[0].sign != terms[1].sign
            label, reverse = "subtract" if minus else "add", terms[0].sign < 0
            make = partial(add, label=label, steps=tuple(steps), minus=minus, reverse=reverse)
        self.parts.append(partial(make, *(term.number for term in terms), total))

    def _three(self, terms: list[Term], value: int, passing: int, total) -> None:
        """The sum of three numbers, or of two numbers and a constant."""
        above = wrapping(len(total) - passing) if passing else total
        # Those that are subtracted come last.
        ordered = sorted((term.without(passing) for term in terms), key=lambda term: -term.sign)
        make = partial(
            add_two_and_constant if len(terms) < 3 else add_three,
            *(term.number for term in ordered),
            above,
            steps=tuple(term.step for term in ordered),
            minus=sum(term.sign < 0 for term in ordered),
        )
        self.parts.append(partial(make, value=value >> passing) if len(terms) < 3 else make)
        if passing:
            start = terms[0].step.cut
            bits = partial(append, start=start, end=start + passing)
            self.parts.append(partial(bits, terms[0].number, above, total))

    def finish(self, row: Row, kind: Finish, result) -> None:
        """Make the result of a row, one clock after the last clock of the graph."""
        node = self.graph.nodes[row.node]
        if isinstance(node, Constant):
            number = wrapping(self.graph.widths[row.node])
            self.parts.append(partial(constant, self.clk, number, value=node.value))
        else:
            number = self.at(row.node, self.spec.latency - 1)
        if row.minus:
            inverted = wrapping(len(number))
            self.parts.append(partial(ops.invert, number, inverted))
            number = inverted
        drop = self.spec.drop(row)
        # A number that is moved left has a 0 there already.
        if kind.even and drop >= 0:
            evened = wrapping(len(number))
            self.parts.append(partial(tie_to_even, number, evened, drop=drop))
            number = evened
        make = partial(finish, label="rectify" if kind.rectified else "finish", drop=drop)
        self.parts.append(partial(make, self.clk, number, result, rectified=kind.rectified))


@block
def constant_matrix(clk, in_data, out_data, *, spec: ConstantMatrix):
    """Sums of products with constants, all of a layer, in shifted adds that share what they can.

    No multiplier. Latency: ``spec.latency`` clocks, one for every ``spec.adders_per_clock`` adders
    one behind the other; a frame every clock. No reset: data alone.
    """
    numbers = Numbers(clk, in_data, spec)
    for i, (row, kind) in enumerate(zip(spec.graph.rows, spec.row_finishes, strict=True)):
        numbers.finish(row, kind, out_data[i])
    return [part() for part in numbers.parts]
