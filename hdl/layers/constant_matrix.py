"""constant_matrix: every sum of a layer as one graph of shifted adds, without a multiplier."""

from collections.abc import Callable
from functools import partial

from myhdl import Signal, always, always_comb, block, concat, intbv, modbv

from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.shift_add import Alignment, Constant, Input, Row, Sum
from hdl.common.delay import delay

# What is done to a sum is done in one process, in variables wide enough for each step: simulators
# take several times as long for a process each. The sum is inverted twice, which costs nothing and
# changes nothing: without, Yosys merges it with the sum that takes it to a carry-save adder, of a
# third more LUTs. Where bits pass beside the adder it has no need to.


def wrapping(width: int):
    """A signed signal that wraps between two deltas of a simulation, though in no clock."""
    half = 1 << (width - 1)
    return Signal(modbv(0, min=-half, max=half))


@block
def add(low, high, total, *, step: Alignment):
    """Sum of two numbers, less their last bits, the high one moved left."""
    low_cut, high_cut, move, count = step.low_cut, step.high_cut, step.move, len(total)
    half = 1 << max(len(low), len(high) + move, count)

    @always_comb
    def join():
        one = intbv(0, min=-half, max=half)
        other = intbv(0, min=-half, max=half)
        result = intbv(0, min=-half, max=half)
        turned = intbv(0, min=-half, max=half)
        one[:] = low >> low_cut
        other[:] = high >> high_cut
        other[:] = other << move
        turned[:] = one + other
        turned[:] = ~turned
        result[:] = ~turned
        total.next = result[count:].signed()

    return join


@block
def subtract(low, high, total, *, step: Alignment, reverse: bool):
    """The low number minus the high one, each as ``add`` takes it; or the other way round."""
    low_cut, high_cut, move, count = step.low_cut, step.high_cut, step.move, len(total)
    half = 1 << max(len(low), len(high) + move, count)

    if reverse:

        @always_comb
        def join():
            one = intbv(0, min=-half, max=half)
            other = intbv(0, min=-half, max=half)
            result = intbv(0, min=-half, max=half)
            turned = intbv(0, min=-half, max=half)
            one[:] = low >> low_cut
            other[:] = high >> high_cut
            other[:] = other << move
            turned[:] = other - one
            turned[:] = ~turned
            result[:] = ~turned
            total.next = result[count:].signed()

    else:

        @always_comb
        def join():
            one = intbv(0, min=-half, max=half)
            other = intbv(0, min=-half, max=half)
            result = intbv(0, min=-half, max=half)
            turned = intbv(0, min=-half, max=half)
            one[:] = low >> low_cut
            other[:] = high >> high_cut
            turned[:] = one - other
            turned[:] = ~turned
            result[:] = ~turned
            total.next = result[count:].signed()

    return join


@block
def add_above(low, high, total, *, step: Alignment, minus: bool):
    """The low number plus or minus the high one, whose last bits are those of the low one."""
    end = step.low_cut
    start, count = end + step.move, len(total) - step.move
    half = 1 << max(len(low), len(high), count)

    if minus:

        @always_comb
        def join():
            one = intbv(0, min=-half, max=half)
            result = intbv(0, min=-half, max=half)
            one[:] = low >> start
            result[:] = one - high
            total.next = concat(result[count:], low[start:end]).signed()

    else:

        @always_comb
        def join():
            one = intbv(0, min=-half, max=half)
            result = intbv(0, min=-half, max=half)
            one[:] = low >> start
            result[:] = one + high
            total.next = concat(result[count:], low[start:end]).signed()

    return join


@block
def add_constant(number, total, *, value: int, cut: int, move: int, minus: bool):
    """A constant plus a number, less its last bits and moved left; or minus that."""
    count = len(total)
    half = 1 << max(len(number) + move, count, abs(value).bit_length() + 1)
    # A number is negated by inverting it and adding 1.
    start = value + 1 if minus else value

    if minus:

        @always_comb
        def join():
            one = intbv(0, min=-half, max=half)
            result = intbv(0, min=-half, max=half)
            turned = intbv(0, min=-half, max=half)
            one[:] = number >> cut
            one[:] = one << move
            one[:] = ~one
            turned[:] = start + one
            turned[:] = ~turned
            result[:] = ~turned
            total.next = result[count:].signed()

    else:

        @always_comb
        def join():
            one = intbv(0, min=-half, max=half)
            result = intbv(0, min=-half, max=half)
            turned = intbv(0, min=-half, max=half)
            one[:] = number >> cut
            one[:] = one << move
            turned[:] = start + one
            turned[:] = ~turned
            result[:] = ~turned
            total.next = result[count:].signed()

    return join


@block
def invert(number, inverted):
    """Every bit of a number inverted: less by 1 than its negative."""

    @always_comb
    def turn():
        inverted.next = ~number

    return turn


@block
def finish(clk, number, result, *, drop: int):
    """A row's result a clock later: its number without the last bits, saturated.

    ``drop`` below 0 moves it left.
    """
    cut, move = max(0, drop), max(0, -drop)
    count, sign = len(result), max(len(number) + move, len(result))
    places = count - 1
    half = 1 << sign
    high, low = (1 << places) - 1, -(1 << places)

    if len(number) - drop <= count:

        @always(clk.posedge)
        def keep():
            word = intbv(0, min=-half, max=half)
            word[:] = number >> cut
            word[:] = word << move
            result.next = word[count:].signed()

    else:

        @always(clk.posedge)
        def keep():
            word = intbv(0, min=-half, max=half)
            top = intbv(0, min=-half, max=half)
            word[:] = number >> cut
            word[:] = word << move
            top[:] = word >> places
            if top == 0 or top == -1:
                result.next = word[count:].signed()
            elif word[sign]:
                result.next = low
            else:
                result.next = high

    return keep


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
                # MyHDL refuses a port that nothing reads.
                in_data[node.number].read = True
                self._there[place, 0] = in_data[node.number]
            elif isinstance(node, Sum):
                total = wrapping(self.graph.widths[place])
                self.parts.append(self._sum(place, node, total))
                self._there[place, self.clocks[place]] = total

    def at(self, place: int, clock: int):
        """The number at a node, in the clock in which it is made or a later one."""
        if (place, clock) not in self._there:
            before = self.at(place, clock - 1)
            late = wrapping(len(before))
            self.parts.append(partial(delay, self.clk, None, before, late, clocks=1))
            self._there[place, clock] = late
        return self._there[place, clock]

    def _sum(self, place: int, node: Sum, total) -> Callable:
        step, clock = self.graph.step(place), self.clocks[place]
        operands = [
            (node.low, step.low_cut, 0, node.low_sign),
            (node.high, step.high_cut, step.move, node.high_sign),
        ]
        constants = [isinstance(self.graph.nodes[operand[0]], Constant) for operand in operands]
        if any(constants):
            number, cut, move, sign = operands[constants.index(False)]
            constant, constant_cut, constant_move, constant_sign = operands[constants.index(True)]
            value = self.graph.nodes[constant].value >> constant_cut << constant_move
            return partial(
                add_constant,
                self.at(number, clock),
                total,
                value=constant_sign * value,
                cut=cut,
                move=move,
                minus=sign < 0,
            )
        pair = self.at(node.low, clock), self.at(node.high, clock)
        minus = node.low_sign != node.high_sign
        if step.move and node.low_sign > 0:
            return partial(add_above, *pair, total, step=step, minus=minus)
        if minus:
            return partial(subtract, *pair, total, step=step, reverse=node.low_sign < 0)
        return partial(add, *pair, total, step=step)

    def finish(self, row: Row, result) -> None:
        """A row's result, in the clock behind the last."""
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
        self.parts.append(partial(finish, self.clk, number, result, drop=self.spec.drop(row)))


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
    No multiplier. Latency: ``spec.latency`` clocks, one for every ``spec.adders_per_clock`` adders
    one behind the other; a frame every clock. No reset: data alone.
    """
    numbers = Numbers(clk, in_data, spec)
    for i, row in enumerate(spec.graph.rows):
        numbers.finish(row, out_data[i])
    return [part() for part in numbers.parts]
