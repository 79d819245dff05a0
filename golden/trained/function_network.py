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

# A spline of the input as in ``Function``, the slope of a straight edge, or None for none.
Edge = tuple[float, ...] | float | None


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
        samples = inputs - self.earlier
        copies = _Layer(inputs)
        places: list[list[tuple[int, float]]] = [[] for _ in self.first]
        for h, (edges, scale) in enumerate(zip(self.first, self.scales, strict=True)):
            for i, edge in enumerate(edges):
                if edge is None:
                    continue
                later = i >= samples
                into = EARLIER_SCALE if later else SAMPLE_SCALE
                shift = into * HALF_UNIT * later
                row = np.zeros(inputs)
                row[i] = into
                copies.start(row, shift)
                name = f"f{h + 1}_{i + 1}"
                place, weight = copies.end(name, edge, into, shift, scale, LARGEST)
                places[h].append((place, weight))
        sums = _Layer(copies.nodes)
        last = np.zeros((len(self.second), 0))
        biases = np.array(self.biases, dtype=np.float64)
        for o, edges in enumerate(self.second):
            for h, edge in enumerate(edges):
                if edge is None:
                    continue
                row = np.zeros(copies.nodes)
                for place, weight in places[h]:
                    row[place] = weight
                scale = self.scales[h]
                parts, constant = _parts(edge, scale) if self.products else ([edge], 0.0)
                biases[o] += constant
                for part in parts:
                    sums.start(row, scale * self.offsets[h] if self.offsets else 0.0)
                    name = f"g{o + 1}_{h + 1}"
                    _, weight = sums.end(name, part, scale, 0.0, 1.0, LARGEST_OUTPUT)
                    column = np.zeros((len(self.second), 1))
                    column[o] = weight
                    last = np.concatenate([last, column], axis=1)
        output = Dense(last, biases)
        return DenseNetwork((copies.dense(), sums.dense(), output))


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


def _parts(edge: Edge, scale: float) -> tuple[list[Edge], float]:
    """What is added up for an edge of a hidden sum, and a constant.

    A function that is larger than a word is a straight line and what is left of it, where these
    take fewer steps. Both go on as far as the word of the sum does.
    """
    if not isinstance(edge, tuple):
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


class _Layer:
    """A layer to which one node after the other is added."""

    def __init__(self, inputs: int) -> None:
        self.inputs = inputs
        self.rows: list[Real] = []
        self.biases: list[float] = []
        self.functions: list[Function] = []

    @property
    def nodes(self) -> int:
        return len(self.rows)

    def start(self, row: Real, bias: float) -> None:
        """Add the sum of a node."""
        self.rows.append(row)
        self.biases.append(bias)

    def end(
        self, name: str, edge: Edge, into: float, shift: float, scale: float, largest: float
    ) -> tuple[int, float]:
        """Add the function of a node; return its place and the weight that the next layer gives it.

        The node's sum is ``into`` times the edge's input, and ``shift`` more. The next layer is to
        get ``scale`` times the edge. A function whose values or slopes do not stay within
        ``largest`` is divided by a whole number, which becomes the weight.
        """
        if isinstance(edge, tuple):
            low, high, most, *coefficients = edge
            parts = _times(edge, into, scale, largest)
            ends = into * low + shift, into * high + shift
            spline = *ends, *(scale / parts * value for value in (most, *coefficients))
            self.functions.append(Function(name, spline=spline))
            return self.nodes - 1, float(parts)
        assert edge is not None
        self.functions.append(ITSELF)
        return self.nodes - 1, scale * edge / into

    def dense(self) -> Dense:
        """The layer."""
        names = TABLE + ",".join(function.name for function in self.functions)
        rows = np.array(self.rows).reshape(self.nodes, self.inputs)
        biases = np.array(self.biases)
        return Dense(rows, biases, names, functions=tuple(self.functions))
