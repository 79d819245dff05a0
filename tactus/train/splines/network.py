"""A network of learned functions: every edge is a spline of one variable, every node a sum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from golden.numbers.real import Real
from golden.trained.spline_basis import Basis

# The range of the splines of hidden sums. Training makes the sums fit it.
HIDDEN_RANGE = (-1.0, 1.0)
# Standard deviations at the start: of the straight and of the bent part of the functions f, and of
# the slope of the functions g.
STARTING_SIZES, STARTING_SLOPE = (0.6, 0.4), 0.3


@dataclass(frozen=True)
class SplineNetwork:
    """The sums ``s_h = sum over i of f_hi(x_i)`` and ``y_o = b_o + sum over h of g_oh(s_h)``.

    bases: The splines of each input.
    hidden: The splines of every hidden sum.
    first, shape (hidden, inputs, splines of an input): The coefficients of the functions f.
    second, shape (outputs, hidden, splines of a hidden sum): The coefficients of the functions g.
    biases: shape (outputs,).
    """

    bases: tuple[Basis, ...]
    hidden: Basis
    first: Real
    second: Real
    biases: Real

    @property
    def shape(self) -> tuple[int, int, int]:
        """The numbers of inputs, hidden sums and outputs."""
        return self.first.shape[1], self.first.shape[0], self.second.shape[0]

    def spread(self, frames: ArrayLike) -> Real:
        """The splines of all inputs at each frame, shape (frames, inputs * splines)."""
        return spread(self.bases, np.asarray(frames, dtype=np.float64))

    def sums(self, spread: Real) -> Real:
        """The hidden sums of frames that ``spread`` has turned into splines."""
        nodes = len(self.first)
        return np.asarray(spread @ self.first.reshape(nodes, -1).T)

    def process(self, frames: ArrayLike) -> Real:
        """Outputs, shape (frames, outputs), of frames, shape (frames, inputs)."""
        values, _ = self.hidden.at(self.sums(self.spread(frames)))
        return np.asarray(np.einsum("rhk,ohk->ro", values, self.second) + self.biases)

    def packed(self) -> Real:
        """All coefficients and biases in one vector."""
        return np.concatenate([self.first.ravel(), self.second.ravel(), self.biases])

    def unpacked(self, vector: Real) -> SplineNetwork:
        """The inverse of ``packed``, for a network with the splines of this one."""
        cuts = np.cumsum([self.first.size, self.second.size])
        first, second, biases = np.split(vector, cuts)
        return replace(
            self,
            first=first.reshape(self.first.shape),
            second=second.reshape(self.second.shape),
            biases=biases,
        )


def spread(bases: Sequence[Basis], frames: Real) -> Real:
    """The splines of all inputs at each frame, shape (frames, inputs * splines)."""
    return np.concatenate(
        [basis.at(column)[0] for basis, column in zip(bases, frames.T, strict=True)], axis=1
    )


def starting(
    bases: Sequence[Basis],
    hidden_intervals: int,
    nodes: int,
    outputs: int,
    rng: np.random.Generator,
) -> SplineNetwork:
    """Random, gently curved functions, whose hidden sums mostly lie in their range."""
    hidden = Basis(*HIDDEN_RANGE, hidden_intervals)
    inputs = len(bases)
    # A random straight line and a random parabola for each edge.
    across = np.stack([np.linspace(-1, 1, basis.count) for basis in bases])
    lines, bends = (
        rng.normal(0, size, (nodes, inputs, 1)) / np.sqrt(inputs) for size in STARTING_SIZES
    )
    first = lines * across + bends * (across**2 - 0.4)
    second = rng.normal(0, STARTING_SLOPE, (outputs, nodes, 1)) * hidden.centres
    return SplineNetwork(tuple(bases), hidden, first, second, np.zeros(outputs))
