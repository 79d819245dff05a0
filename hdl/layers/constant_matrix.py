"""constant_matrix: every sum of a layer as one graph of shifted adds, without a multiplier."""

from collections.abc import Callable
from functools import partial

from myhdl import Signal, always, always_comb, block, concat, modbv

from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.shift_add import Constant, Input, Sum
from hdl.common.delay import connect
from hdl.common.signals import fixed, flag, unsigned


def wrapping(width: int):
    """A signed signal that wraps between two deltas of a simulation, though in no clock."""
    half = 1 << (width - 1)
    return Signal(modbv(0, min=-half, max=half))


@block
def cut(number, kept, *, places: int):
    """``number`` without its last ``places``."""

    @always_comb
    def move():
        kept.next = number >> places

    return move


@block
def moved(number, wide, *, places: int):
    """``number`` moved left."""
    same = wrapping(len(wide))

    @always_comb
    def widen():
        same.next = number

    @always_comb
    def move():
        wide.next = same << places

    return widen, move


@block
def add(one, other, total, *, minus: bool):
    """Sum or difference of two numbers."""
    result, turned = wrapping(len(total)), wrapping(len(total))

    if minus:

        @always_comb
        def join():
            result.next = one - other

    else:

        @always_comb
        def join():
            result.next = one + other

    return join, invert(result, turned), invert(turned, total)


@block
def add_above(low, high, total, *, places: int, minus: bool):
    """``low`` plus or minus ``high`` moved left, whose last bits are those of ``low``."""
    rest = wrapping(max(1, len(low) - places))
    part = wrapping(len(total) - places)
    last = unsigned(places)
    count = len(part)

    @always_comb
    def split():
        rest.next = low >> places
        last.next = low[places:]

    @always_comb
    def fill():
        total.next = concat(part[count:], last).signed()

    return split, add(rest, high, part, minus=minus), fill


@block
def add_constant(number, total, *, value: int, minus: bool):
    """A constant plus or minus a number: a number is negated by inverting it and adding 1."""
    if not minus:

        @always_comb
        def join():
            total.next = number + value

        return join

    inverted = wrapping(len(number))
    more = value + 1

    @always_comb
    def take():
        total.next = more + inverted

    return invert(number, inverted), take


@block
def saturate(word, result):
    """``word``, or the end of the range of ``result`` that it is beyond."""
    places, sign = len(result) - 1, len(word) - 1
    if sign <= places:
        return connect(word, result)
    top = wrapping(len(word) - places)
    same = wrapping(len(result))
    inside = flag()
    high, low = (1 << places) - 1, -(1 << places)
    count = len(result)

    @always_comb
    def split():
        top.next = word >> places
        same.next = word[count:].signed()

    @always_comb
    def judge():
        inside.next = (top == 0) or (top == -1)

    @always_comb
    def choose():
        if inside:
            result.next = same
        elif word[sign]:
            result.next = low
        else:
            result.next = high

    return split, judge, choose


@block
def keep(clk, data, data_late):
    """``data`` a clock later."""

    @always(clk.posedge)
    def hold():
        data_late.next = data

    return hold


@block
def constant(clk, number, *, value: int):
    """A constant in a register, which keeps it from being undriven."""

    @always(clk.posedge)
    def hold():
        number.next = value

    return hold


class Numbers:
    """The number at each node of the graph in any clock, and the hardware that brings it there."""

    def __init__(self, clk, in_data, spec: ConstantMatrix):
        self.clk, self.spec, self.graph, self.clocks = clk, spec, spec.graph, spec.clocks
        # Blocks still to be made, which MyHDL wants made inside a block.
        self.parts: list[Callable] = []
        # By node and clock.
        self._there = {}
        for place, node in enumerate(self.graph.nodes):
            if isinstance(node, Input):
                in_data[node.number].read = True
                self._there[place, 0] = in_data[node.number]
            elif isinstance(node, Sum):
                self._make(place, node)

    def at(self, place: int, clock: int):
        """The number at a node, in the clock in which it is made or a later one."""
        if (place, clock) not in self._there:
            before = self.at(place, clock - 1)
            late = wrapping(len(before))
            self.parts.append(partial(keep, self.clk, before, late))
            self._there[place, clock] = late
        return self._there[place, clock]

    def _operand(self, place: int, clock: int, dropped: int):
        number = self.at(place, clock)
        if not dropped:
            return number
        kept = wrapping(max(1, len(number) - dropped))
        self.parts.append(partial(cut, number, kept, places=dropped))
        return kept

    def _make(self, place: int, node: Sum) -> None:
        step, clock = self.graph.step(place), self.clocks[place]
        total = wrapping(self.graph.widths[place])
        self._there[place, clock] = total
        operands = [
            (node.low, step.low_cut, 0, node.low_sign),
            (node.high, step.high_cut, step.move, node.high_sign),
        ]
        fixed_ones = [o for o in operands if isinstance(self.graph.nodes[o[0]], Constant)]
        if fixed_ones:
            ((constant, dropped, move, sign),) = fixed_ones
            value = sign * (self.graph.nodes[constant].value >> dropped << move)
            ((other, dropped, move, sign),) = [o for o in operands if o not in fixed_ones]
            number = self._moved(self._operand(other, clock, dropped), move)
            self.parts.append(partial(add_constant, number, total, value=value, minus=sign < 0))
            return
        low = self._operand(node.low, clock, step.low_cut)
        high = self._operand(node.high, clock, step.high_cut)
        if node.low_sign < 0:
            self.parts.append(partial(add, self._moved(high, step.move), low, total, minus=True))
        elif step.move:
            minus = node.high_sign < 0
            self.parts.append(partial(add_above, low, high, total, places=step.move, minus=minus))
        else:
            self.parts.append(partial(add, low, high, total, minus=node.high_sign < 0))

    def _moved(self, number, places: int):
        if not places:
            return number
        wide = wrapping(len(number) + places)
        self.parts.append(partial(moved, number, wide, places=places))
        return wide

    def result(self, row, drop: int, result) -> None:
        """A row's result in the last clock."""
        node = self.graph.nodes[row.node]
        if isinstance(node, Constant):
            number = wrapping(self.graph.widths[row.node])
            self.parts.append(partial(constant, self.clk, number, value=node.value))
        else:
            number = self.at(row.node, self.spec.latency - 1)
        if row.minus:
            inverted = wrapping(len(number))
            self.parts.append(partial(invert, number, inverted))
            number = inverted
        if drop > 0:
            word = wrapping(max(1, len(number) - drop))
            self.parts.append(partial(cut, number, word, places=drop))
        else:
            word = self._moved(number, -drop)
        self.parts.append(partial(saturate, word, result))


@block
def invert(number, inverted):
    """Every bit of a number inverted: less by 1 than its negative."""

    @always_comb
    def turn():
        inverted.next = ~number

    return turn


@block
def constant_matrix(clk, in_data, out_data, *, spec: ConstantMatrix):
    """Sums of products with constants, all of a layer, in shifted adds that share what they can.

    Parameters
    ----------
    in_data : Words of signed ``spec.in_fmt``
        The samples, ports ``in_data_0``, ``in_data_1``, ..., all in one clock.
    out_data : Words of signed ``spec.out_fmt``
        The results, ports ``out_data_0``, ``out_data_1``, ..., all in one clock.
    spec : ConstantMatrix
        Weights, biases, formats and graph; the twin states what is cut, rounding and overflow.

    Notes
    -----
    No multiplier. Latency: ``spec.latency`` clocks, one for every ``spec.adders_per_clock`` adders one
    behind the other; a frame every clock. No reset: data alone.
    """
    numbers = Numbers(clk, in_data, spec)
    results = [fixed(spec.out_fmt) for _ in spec.weights]
    for i, row in enumerate(spec.graph.rows):
        numbers.result(row, spec.drop(row), results[i])
    parts = [part() for part in numbers.parts]
    return parts, [keep(clk, results[i], out_data[i]) for i in range(len(results))]
