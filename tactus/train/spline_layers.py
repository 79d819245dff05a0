"""Networks of learned functions as layers, which every program takes and engines add up."""

from collections.abc import Sequence
from math import floor, log2

import numpy as np

from golden.numbers.real import Real
from golden.trained.function import HIGH
from golden.trained.function_network import Edge, FunctionNetwork
from golden.trained.spline_basis import Basis
from tactus.train.splines.edges import CURVED, STRAIGHT
from tactus.train.splines.training import Learned

# With the inputs of training, functions fill this part of their range at most, and so do sums where
# hardware has no products. Beyond it, a function is level.
FILLED = 0.8
# The part that hidden sums fill where hardware has products.
FILLED_WORD = 0.9
# The range of a function that is added to a hidden sum.
MOST_HIDDEN = 0.99 * HIGH
# A product may be so much larger than a word, because it is added up before anything is rounded. A
# larger one would take many steps: each holds a part of its weight.
LARGER = 16.0
# A sum that hardly changes is not made larger without end.
LEAST = 2.0**-10


def function_network(
    learned: Learned, inputs: Real, earlier: int, products: bool = True
) -> FunctionNetwork:
    """A trained network with what hardware must know.

    Where hardware has products, the middle of what a hidden sum reaches becomes 0, and a scale
    makes it fill the word, so that the segments of a table of it are narrow. Where every edge is a
    table of a few bits, a word that is filled more takes more LUTs: those of digit-tables would
    take 1222 and not 1183, with the same errors.

    A function goes straight on beyond the range in which it was trained, until it would leave the
    format of its sum; from there it is level.

    inputs, shape (rows, inputs): The inputs of training.
    earlier: How many of the inputs, at the end, are outputs of earlier networks.
    products: Whether hardware multiplies, so that a straight line is no table.
    """
    network, edges = learned.network, learned.edges
    sums = network.sums(network.spread(inputs))
    first, offsets, scales, hidden, around = [], [], [], [], []
    for kinds, rows, sum_ in zip(edges.first, network.first, sums.T, strict=True):
        centred, constant = _centred(kinds, network.bases, rows)
        reached = [
            _reached(basis, row, x) / (LARGER if products and kind == STRAIGHT else 1)
            for kind, basis, row, x in zip(kinds, network.bases, centred, inputs.T, strict=True)
        ]
        middle = float(sum_.max() + sum_.min()) / 2 if products else 0.0
        around.append(sum_ - middle)
        largest = max(*reached, float(np.abs(around[-1]).max()), LEAST)
        # A scale that is a power of two changes no bit of a slope.
        power = 2.0 ** floor(log2(FILLED * HIGH / largest))
        scales.append(FILLED_WORD * HIGH / largest if products else power)
        first.append(
            [
                _edge(kind, basis, row, MOST_HIDDEN / scales[-1])
                for kind, basis, row in zip(kinds, network.bases, centred, strict=True)
            ]
        )
        offsets.append(constant - middle)
        hidden.append(_moved(network.hidden, -middle))
    biases = network.biases.copy()
    second = []
    for o, (kinds, rows) in enumerate(zip(edges.second, network.second, strict=True)):
        centred, constant = _centred(kinds, hidden, rows)
        biases[o] += constant
        second.append(
            [
                _edge(kind, basis, row, _reached(basis, row, x) / FILLED)
                for kind, basis, row, x in zip(kinds, hidden, centred, around, strict=True)
            ]
        )
    return FunctionNetwork(
        first, second, biases.tolist(), scales, earlier, offsets, products=products
    )


def _moved(basis: Basis, way: float) -> Basis:
    """The splines of an input to which a number is added."""
    return Basis(basis.low + way, basis.high + way, basis.intervals)


def _reached(basis: Basis, coefficients: Real, x: Real) -> float:
    """The largest magnitude of a function, over its range and over some inputs."""
    values = np.abs(basis.function(x, coefficients)).max()
    return max(float(values), float(np.abs(coefficients).max()), LEAST)


def _centred(
    kinds: Sequence[int], bases: Sequence[Basis], rows: Sequence[Real]
) -> tuple[list[Real], float]:
    """The coefficients of the edges of a sum without their constants, and the constants together.

    The constant of a straight edge is its value where its input is 0.
    """
    constants = [
        float(np.polyfit(basis.centres, row, 1)[1] if kind == STRAIGHT else row.mean())
        for kind, basis, row in zip(kinds, bases, rows, strict=True)
    ]
    centred = [row - constant for row, constant in zip(rows, constants, strict=True)]
    return centred, float(sum(constants))


def _edge(kind: int, basis: Basis, coefficients: Real, most: float) -> Edge:
    """An edge whose values stay within -most and most."""
    if kind == CURVED:
        return basis.low, basis.high, most, *coefficients.tolist()
    if kind == STRAIGHT:
        return float(np.polyfit(basis.centres, coefficients, 1)[0])
    return None
