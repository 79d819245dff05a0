"""Networks of learned functions as layers: each edge is a function, each node adds up its edges.

        s_h = a_h + sum over i of f_hi(x_i)        y_o = b_o + sum over h of g_oh(s_h)

As layers, the nodes of the first one take an input each and look up a function f of it; those of
the second add them up and look up a function g of each sum; the last adds these up. So every
program that takes a network of layers takes this one. An engine recognises it and adds the
functions up without words between (``golden.engine.sums_of_functions``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from golden.dense import Dense, DenseNetwork
from golden.function import ITSELF, TABLE, Function
from golden.precision import SIGNAL
from golden.real import Real
from golden.spline_basis import DEGREE

# Values and slopes of hidden sums and of outputs have room in hardware up to these.
LARGEST, LARGEST_OUTPUT = 7.99, 0.999
# A sample as a sum q that is its word as it is, and an output of an earlier network likewise.
SAMPLE_SCALE, EARLIER_SCALE = 4.0, 8.0
# An earlier output comes with half a unit of its last place added.
HALF_UNIT = 2.0 ** -(SIGNAL.frac + 1)

# A spline of the input as in ``Function``, the slope of a straight edge, or None for none.
Edge = tuple[float, ...] | float | None


@dataclass(frozen=True)
class FunctionNetwork:
    """A network of learned functions.

    Attributes
    ----------
    first : sequence of sequences of Edge
        For each hidden sum an edge for each input.
    second : sequence of sequences of Edge
        For each output an edge for each hidden sum.
    biases : sequence of float
        The constants of the outputs.
    scales : sequence of float
        By what each hidden sum is multiplied in hardware, where sums from -8 to 8 have room.
    earlier : int
        How many of the inputs, at the end, are outputs of earlier networks.
    offsets : sequence of float
        The constants of the hidden sums; empty where there are none.
    """

    first: Sequence[Sequence[Edge]]
    second: Sequence[Sequence[Edge]]
    biases: Sequence[float]
    scales: Sequence[float]
    earlier: int = 0
    offsets: Sequence[float] = ()

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
        for o, edges in enumerate(self.second):
            for h, edge in enumerate(edges):
                if edge is None:
                    continue
                row = np.zeros(copies.nodes)
                for place, weight in places[h]:
                    row[place] = weight
                scale = self.scales[h]
                sums.start(row, scale * self.offsets[h] if self.offsets else 0.0)
                _, weight = sums.end(f"g{o + 1}_{h + 1}", edge, scale, 0.0, 1.0, LARGEST_OUTPUT)
                column = np.zeros((len(self.second), 1))
                column[o] = weight
                last = np.concatenate([last, column], axis=1)
        output = Dense(last, np.array(self.biases, dtype=np.float64))
        return DenseNetwork((copies.dense(), sums.dense(), output))


def of_parabolas(shape: Sequence[int], earlier: int) -> FunctionNetwork:
    """A network all of whose functions are the same small parabola."""
    inputs, hidden, outputs = shape
    parabola = -1.0, 1.0, 0.9, 0.2, 0.0, 0.0, 0.2
    first, second = [[parabola] * inputs] * hidden, [[parabola] * hidden] * outputs
    return FunctionNetwork(first, second, [0.0] * outputs, [2.0] * hidden, earlier)


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
            width = into * (high - low) / (len(coefficients) - DEGREE)
            steepest = max(abs(b - a) for a, b in pairwise(coefficients)) / width
            parts = max(1, ceil(scale * max(most, steepest) / largest))
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
