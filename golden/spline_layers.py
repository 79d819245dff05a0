"""Networks of learned functions as layers, which every program takes and engines add up."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log2

import numpy as np

from golden.function import HIGH
from golden.function_network import Edge, FunctionNetwork
from golden.real import Real
from golden.spline_basis import Basis
from golden.splines.edges import CURVED, STRAIGHT
from golden.splines.training import Learned

# Hidden sums fill this part of their format at most, with the inputs of training.
FILLED = 0.8
# A function is level before it leaves the format of its sum: of an output, and of a hidden sum.
MOST_OUTPUT, MOST_HIDDEN = 0.99, 0.99 * HIGH
# A sum that hardly changes is not made larger without end.
LEAST = 2.0**-10


def function_network(learned: Learned, inputs: Real, earlier: int) -> FunctionNetwork:
    """A trained network with what hardware must know.

    A function goes straight on beyond the range in which it was trained, until it would leave the
    format of its sum; from there it is level.

    Parameters
    ----------
    learned : Learned
    inputs : float array, shape (rows, inputs)
        The inputs of training.
    earlier : int
        How many of the inputs, at the end, are outputs of earlier networks.
    """
    network, edges = learned.network, learned.edges
    reach = np.abs(network.sums(network.spread(inputs))).max(axis=0)
    first, offsets, scales = [], [], []
    for kinds, rows, most in zip(edges.first, network.first, reach, strict=True):
        centred, constant = _centred(kinds, network.bases, rows)
        largest = max([float(most) / FILLED, *(np.abs(row).max() for row in centred), LEAST])
        # A scale that is a power of two changes no bit of a slope.
        scales.append(2.0 ** floor(log2(MOST_HIDDEN / largest)))
        made = [
            _edge(kind, basis, row, MOST_HIDDEN / scales[-1])
            for kind, basis, row in zip(kinds, network.bases, centred, strict=True)
        ]
        first.append(made)
        offsets.append(constant)
    biases = network.biases.copy()
    second = []
    for o, (kinds, rows) in enumerate(zip(edges.second, network.second, strict=True)):
        hidden = [network.hidden] * len(scales)
        centred, constant = _centred(kinds, hidden, rows)
        biases[o] += constant
        second.append(
            [
                _edge(kind, network.hidden, row, MOST_OUTPUT)
                for kind, row in zip(kinds, centred, strict=True)
            ]
        )
    return FunctionNetwork(first, second, biases.tolist(), scales, earlier, offsets)


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
