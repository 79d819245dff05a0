"""Networks of learned functions as layers, which every program takes and engines add up."""

from __future__ import annotations

from math import ceil, floor, log2

import numpy as np

from golden.function import HIGH
from golden.function_network import Edge, FunctionNetwork
from golden.real import Real
from golden.spline_basis import Basis
from golden.splines.edges import CURVED, FLAT, STRAIGHT
from golden.splines.training import Learned

# Hidden sums fill this part of their format at most, with the inputs of training.
FILLED = 0.8
# A function is level before it leaves the format of its sum: of an output, and of a hidden sum.
MOST_OUTPUT, MOST_HIDDEN = 0.99, 0.99 * HIGH


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
    # A scale that is a power of two changes no bit of a slope.
    scales = [2.0 ** floor(log2(FILLED * HIGH / max(most, 1e-3))) for most in reach]
    first, offsets = [], []
    for kinds, rows, scale in zip(edges.first, network.first, scales, strict=True):
        made = [
            _edge(kind, basis, coefficients, 1.0, MOST_HIDDEN / scale)
            for kind, basis, coefficients in zip(kinds, network.bases, rows, strict=True)
        ]
        constants = (
            _constant(kind, basis, coefficients)
            for kind, basis, coefficients in zip(kinds, network.bases, rows, strict=True)
        )
        first.append(made)
        offsets.append(float(sum(constants)))
    biases = network.biases.copy()
    second = []
    for o, (kinds, rows) in enumerate(zip(edges.second, network.second, strict=True)):
        made = []
        for kind, coefficients, scale in zip(kinds, rows, scales, strict=True):
            # What all coefficients have in common is a constant.
            middle = coefficients.mean()
            biases[o] += middle
            ends = HIGH / scale
            made.append(_edge(kind, network.hidden, coefficients - middle, ends, MOST_OUTPUT))
        second.append(made)
    return FunctionNetwork(first, second, biases.tolist(), scales, earlier, offsets)


def _edge(kind: int, basis: Basis, coefficients: Real, end: float, most: float) -> Edge:
    """An edge whose input reaches from -end to end, and whose values are to stay within most."""
    if kind == CURVED:
        return _extended(basis, coefficients, end, most)
    if kind == STRAIGHT:
        return float(np.polyfit(basis.centres, coefficients, 1)[0])
    return None


def _constant(kind: int, basis: Basis, coefficients: Real) -> float:
    """What an edge that is not curved adds where its input is 0."""
    if kind == CURVED:
        return 0.0
    return float(coefficients.mean() if kind == FLAT else np.polyfit(basis.centres, coefficients, 1)[1])


def _extended(basis: Basis, coefficients: Real, end: float, most: float) -> tuple[float, ...]:
    """A spline on a longer range, straight at first where it goes on, and then level."""
    before = max(0, ceil((basis.low + end) / basis.width))
    behind = max(0, ceil((end - basis.high) / basis.width))
    steps = coefficients[1] - coefficients[0], coefficients[-1] - coefficients[-2]
    left = coefficients[0] - steps[0] * np.arange(before, 0, -1)
    right = coefficients[-1] + steps[1] * np.arange(1, behind + 1)
    ends = basis.low - before * basis.width, basis.high + behind * basis.width
    # No spline leaves the range of its coefficients.
    return *ends, *np.concatenate([left, coefficients, right]).clip(-most, most).tolist()
