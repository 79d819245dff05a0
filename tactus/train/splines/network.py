"""A network of learned functions: every edge is a spline of one variable, every node a sum.

An edge may be curved, straight or flat.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

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
        return self.first.shape[1], self.first.shape[0], self.second.shape[0]

    def spread(self, frames: ArrayLike) -> Real:
        """The splines of all inputs at each frame, shape (frames, inputs * splines)."""
        columns = np.asarray(frames, dtype=np.float64).T
        splines = (basis.at(column)[0] for basis, column in zip(self.bases, columns, strict=True))
        return np.concatenate(list(splines), axis=1)

    def sums(self, spread: Real) -> Real:
        """The hidden sums of frames that ``spread`` has turned into splines."""
        nodes = len(self.first)
        return np.asarray(spread @ self.first.reshape(nodes, -1).T)

    def process(self, frames: ArrayLike) -> Real:
        """Outputs, shape (frames, outputs), of frames, shape (frames, inputs)."""
        return self.from_sums(self.sums(self.spread(frames)))

    def from_sums(self, sums: Real) -> Real:
        """Outputs of the hidden sums of frames."""
        values, _ = self.hidden.at(sums)
        return np.asarray(np.einsum("rhk,ohk->ro", values, self.second) + self.biases)

    def packed(self) -> Real:
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


# What an edge is. The number is that of its steps on an engine: nothing; a product; an intercept
# and a slope from a table.
FLAT, STRAIGHT, CURVED = 0, 1, 2


@dataclass(frozen=True)
class Edges:
    """What every edge is.

    first: shape (hidden, inputs).
    second: shape (outputs, hidden).
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]

    @classmethod
    def curved(cls, shape: tuple[int, int, int]) -> Edges:
        inputs, hidden, outputs = shape
        return cls(np.full((hidden, inputs), CURVED), np.full((outputs, hidden), CURVED))

    @property
    def kinds(self) -> NDArray[np.int64]:
        """What each edge is, in the order of the coefficients."""
        return np.concatenate([self.first.ravel(), self.second.ravel()])

    def with_kind(self, number: int, kind: int) -> Edges:
        """The same edges, with another kind of one of them, counted as in ``kinds``."""
        kinds = self.kinds
        kinds[number] = kind
        first, second = np.split(kinds, [self.first.size])
        found = Edges(first.reshape(self.first.shape), second.reshape(self.second.shape))
        # A sum that nothing uses, or that is constant, needs no edges.
        used = (found.second != FLAT).any(axis=0) & (found.first != FLAT).any(axis=1)
        return replace(found, first=found.first * used[:, np.newaxis], second=found.second * used)

    def freedom(self, network: SplineNetwork) -> Real:
        """The matrix that makes coefficients of parameters: ``coefficients = matrix @ parameters``.

        Each kind of edge has its own columns: every coefficient, or a constant and a slope, or a
        constant.
        """
        blocks, layers = [], (network.first, network.second)
        sizes = [layer.shape[2] for layer in layers for _ in layer.reshape(-1, layer.shape[2])]
        for kind, size in zip(self.kinds, sizes, strict=True):
            columns = np.stack([np.ones(size), np.linspace(-1, 1, size)], axis=1)
            blocks.append(np.eye(size) if kind == CURVED else columns[:, : 1 + kind])
        return np.asarray(block_diag(*blocks, np.eye(len(network.biases))))


def bends(network: SplineNetwork, inputs: Real) -> tuple[Real, Real]:
    """How far each edge is from straight and from flat, in every output.

    Returns, shape (edges, rows, outputs): What the outputs change, in first order, if the edge
        becomes the straight line, or the constant, that is nearest on these rows.
    """
    sums = network.sums(network.spread(inputs))
    values, slopes = network.hidden.at(sums)
    back = np.einsum("rhk,ohk->rho", slopes, network.second)
    ones = np.eye(len(network.second))
    # What an edge reads, its function of it, and the derivatives of the outputs by that.
    edges = [
        (x, basis.at(x)[0] @ edge, back[:, h])
        for h, row in enumerate(network.first)
        for x, basis, edge in zip(inputs.T, network.bases, row, strict=True)
    ] + [
        (sums[:, h], values[:, h] @ edge, ones[o])
        for o, row in enumerate(network.second)
        for h, edge in enumerate(row)
    ]
    found = [[miss[:, np.newaxis] * by for miss in _misses(x, y)] for x, y, by in edges]
    straight, flat = (np.array(part) for part in zip(*found, strict=True))
    return straight, flat


def _misses(x: Real, y: Real) -> tuple[Real, Real]:
    """The residuals of y from its nearest line over x, and from its mean."""
    off = y - y.mean()
    along = x - x.mean()
    spread = float(along @ along)
    return off - (float(along @ off) / spread if spread > 0 else 0.0) * along, off
