"""Networks of learned functions as layers: each edge is a function, each node adds up its edges.

        s_h = a_h + sum over i of f_hi(x_i)        y_o = b_o + sum over h of g_oh(s_h)

As layers, the nodes of the first one take an input each and look up a function f of it; those of
the second add them up and look up a function g of each sum; the last adds these up. So every
program that takes a network of layers takes this one. An engine recognises it and adds the
functions up without words between (``golden.engine.sums_of_functions``).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import NamedTuple

import numpy as np

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import Dense, DenseNetwork
from golden.trained.function import HIGH, ITSELF, TABLE, Function
from golden.trained.spline_basis import DEGREE, Basis

# Values and slopes of hidden sums and of outputs have room in hardware up to these.
LARGEST, LARGEST_OUTPUT = 7.99, 0.999
# A sample as a sum q that is its word as it is, and an output of an earlier network likewise.
SAMPLE_SCALE, EARLIER_SCALE = 4.0, 8.0
# An earlier output comes with half a unit of its last place added.
HALF_UNIT = 2.0 ** -(SIGNAL.frac + 1)

# Places of a sum at which a function is compared with a straight line.
PLACES = 257

# A spline of the input as in ``Function``, or the slope of a straight edge.
Curve = tuple[float, ...] | float
# None for no edge.
Edge = Curve | None


@dataclass(frozen=True)
class FunctionNetwork:
    """A network of learned functions.

    first: For each hidden sum an edge for each input.
    second: For each output an edge for each hidden sum.
    biases: The constants of the outputs.
    scales: By what each hidden sum is multiplied in hardware, where sums from -8 to 8 have room.
    earlier: How many of the inputs, at the end, are outputs of earlier networks.
    offsets: The constants of the hidden sums; empty where there are none.
    products: Whether hardware multiplies, so that a straight line takes less than a table. Then a
        function that is larger than a word may become a line and what is left of it.
    """

    first: Sequence[Sequence[Edge]]
    second: Sequence[Sequence[Edge]]
    biases: Sequence[float]
    scales: Sequence[float]
    earlier: int = 0
    offsets: Sequence[float] = ()
    products: bool = True

    def layers(self) -> DenseNetwork:
        """The network as three layers."""
        inputs = len(self.first[0])
        copies: list[_Node] = []
        for h, (edges, scale) in enumerate(zip(self.first, self.scales, strict=True)):
            for i, edge in enumerate(edges):
                if edge is not None:
                    later = i >= inputs - self.earlier
                    into = EARLIER_SCALE if later else SAMPLE_SCALE
                    shift = into * HALF_UNIT * later
                    name = f"f{h + 1}_{i + 1}"
                    looked_up = _looked_up(name, edge, into, shift, scale, LARGEST)
                    copies.append(_Node(into * np.eye(inputs)[i], shift, h, *looked_up))
        rows = _weights(copies, len(self.first))
        sums: list[_Node] = []
        biases = np.array(self.biases, dtype=np.float64)
        for o, edges in enumerate(self.second):
            for h, edge in enumerate(edges):
                if edge is not None:
                    scale = self.scales[h]
                    parts, constant = _parts(edge, scale, self.products)
                    biases[o] += constant
                    offset = scale * self.offsets[h] if self.offsets else 0.0
                    for part in parts:
                        name = f"g{o + 1}_{h + 1}"
                        looked_up = _looked_up(name, part, scale, 0.0, 1.0, LARGEST_OUTPUT)
                        sums.append(_Node(rows[h], offset, o, *looked_up))
        output = Dense(_weights(sums, len(self.second)), biases)
        return DenseNetwork((_layer(copies), _layer(sums), output))


def of_parabolas(shape: Sequence[int], earlier: int) -> FunctionNetwork:
    """A network all of whose functions are the same small parabola."""
    inputs, hidden, outputs = shape
    parabola = -1.0, 1.0, 0.9, 0.2, 0.0, 0.0, 0.2
    first, second = [[parabola] * inputs] * hidden, [[parabola] * hidden] * outputs
    return FunctionNetwork(first, second, [0.0] * outputs, [2.0] * hidden, earlier)


def _times(spline: Sequence[float], into: float, scale: float, largest: float) -> int:
    """By what ``scale`` times a function is divided, so that it stays within ``largest``.

    Its slopes are those by ``into`` times its input.
    """
    low, high, most, *coefficients = spline
    width = into * (high - low) / (len(coefficients) - DEGREE)
    steepest = max(abs(b - a) for a, b in pairwise(coefficients)) / width
    return max(1, ceil(scale * max(most, steepest) / largest))


def _parts(edge: Curve, scale: float, products: bool) -> tuple[list[Curve], float]:
    """What is added up for an edge of a hidden sum, and a constant.

    A function that is larger than a word is a straight line and what is left of it, where these
    take fewer steps and hardware multiplies. Both go on as far as the word of the sum does.
    """
    if not products or not isinstance(edge, tuple):
        return [edge], 0.0
    low, high, _, *coefficients = edge
    basis = Basis(low, high, len(coefficients) - DEGREE)
    x = np.linspace(-1, 1, PLACES) * HIGH / scale
    values = basis.function(x, np.array(coefficients))
    slope = float(np.polyfit(x, values, 1)[0])
    left = values - slope * x
    constant = float(left.max() + left.min()) / 2
    rest = (np.array(coefficients) - slope * basis.centres - constant).tolist()
    spline = low, high, float(np.ptp(left)) / 2, *rest
    before, after = (_times(one, scale, 1.0, LARGEST_OUTPUT) for one in (edge, spline))
    if 2 * before <= 1 + 2 * after:
        return [edge], 0.0
    return [spline, slope], constant


class _Node(NamedTuple):
    """A node with a function; the next layer gives its node ``to`` the function by ``weight``."""

    row: Real
    bias: float
    to: int
    function: Function
    weight: float


def _looked_up(
    name: str, edge: Curve, into: float, shift: float, scale: float, most: float
) -> tuple[Function, float]:
    """The function of a node, and its weight in the next layer, which gets ``scale`` times it.

    The node's sum is ``into`` times the edge's input, and ``shift`` more. A function whose values
    or slopes do not stay within ``most`` is divided by a whole number, which becomes the weight.
    """
    if not isinstance(edge, tuple):
        return ITSELF, scale * edge / into
    low, high, *values = edge
    parts = _times(edge, into, scale, most)
    ends = into * low + shift, into * high + shift
    spline = *ends, *(scale / parts * value for value in values)
    return Function(name, spline=spline), float(parts)


def _weights(nodes: Sequence[_Node], count: int) -> Real:
    """The weights of a layer of ``count`` nodes behind these."""
    found = np.zeros((count, len(nodes)))
    for place, node in enumerate(nodes):
        found[node.to, place] = node.weight
    return found


def _layer(nodes: Sequence[_Node]) -> Dense:
    functions = tuple(node.function for node in nodes)
    names = TABLE + ",".join(function.name for function in functions)
    rows, biases = np.array([node.row for node in nodes]), np.array([node.bias for node in nodes])
    return Dense(rows, biases, names, functions=functions)
