"""Which edges of a network of learned functions are curved, straight or flat."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from golden.numbers.real import Real
from tactus.train.splines.network import SplineNetwork

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
        """All edges of a network with ``shape`` are curved."""
        inputs, hidden, outputs = shape
        return cls(np.full((hidden, inputs), CURVED), np.full((outputs, hidden), CURVED))

    @property
    def kinds(self) -> NDArray[np.int64]:
        """What each edge is, in the order of the coefficients."""
        return np.concatenate([self.first.ravel(), self.second.ravel()])

    @property
    def steps(self) -> int:
        """The steps of a network on an engine.

        The intercepts of curved edges hold the bias of a sum. A sum without a curved edge takes a
        step for its bias, unless nothing uses it.
        """
        used = _used(self.first, self.second)
        first, second = self.first[used], self.second[:, used]
        biases = sum(int((part != CURVED).all(axis=1).sum()) for part in (first, second))
        return int(first.sum() + second.sum()) + biases

    def with_kind(self, number: int, kind: int) -> Edges:
        """The same edges, with another kind of one of them, counted as in ``kinds``."""
        kinds = self.kinds
        kinds[number] = kind
        first, second = np.split(kinds, [self.first.size])
        found = Edges(first.reshape(self.first.shape), second.reshape(self.second.shape))
        # A sum that nothing uses, or that is constant, needs no edges.
        used = _used(found.first, found.second)
        return replace(found, first=found.first * used[:, np.newaxis], second=found.second * used)

    def parameters(self, network: SplineNetwork) -> int:
        """The numbers that define the network: coefficients, and slopes of straight edges."""
        counts = [len(c) for c in coefficients(network)]
        curved = sum(c for c, kind in zip(counts, self.kinds, strict=True) if kind == CURVED)
        return curved + int((self.kinds == STRAIGHT).sum()) + len(network.biases)

    def freedom(self, network: SplineNetwork) -> Real:
        """The matrix that makes coefficients of parameters: ``coefficients = matrix @ parameters``.

        Each kind of edge has its own columns: every coefficient, or a constant and a slope, or a
        constant.
        """
        blocks = []
        for kind, bend in zip(self.kinds, coefficients(network), strict=True):
            across = np.linspace(-1, 1, len(bend))
            columns = np.stack([np.ones(len(bend)), across], axis=1)
            blocks.append(np.eye(len(bend)) if kind == CURVED else columns[:, : 1 + kind])
        return np.asarray(block_diag(*blocks, np.eye(len(network.biases))))


def coefficients(network: SplineNetwork) -> list[Real]:
    """The coefficients of each edge, in the order of ``Edges.kinds``."""
    return [edge for layer in (network.first, network.second) for row in layer for edge in row]


def bends(network: SplineNetwork, inputs: Real) -> tuple[Real, Real]:
    """How far each edge is from straight and from flat, in every output.

    Returns, shape (edges, rows, outputs): What the outputs change, in first order, if the edge
        becomes the straight line, or the constant, that is nearest on these rows.
    """
    sums = network.sums(network.spread(inputs))
    values, slopes = network.hidden.at(sums)
    back = np.einsum("rhk,ohk->rho", slopes, network.second)
    straight: list[Real] = []
    flat: list[Real] = []
    for h, edges in enumerate(network.first):
        for i, edge in enumerate(edges):
            curve = network.bases[i].at(inputs[:, i])[0] @ edge
            for found, miss in zip((straight, flat), _misses(inputs[:, i], curve), strict=True):
                found.append(miss[:, np.newaxis] * back[:, h])
    for o, edges in enumerate(network.second):
        for h, edge in enumerate(edges):
            for found, miss in zip(
                (straight, flat), _misses(sums[:, h], values[:, h] @ edge), strict=True
            ):
                here = np.zeros((len(inputs), len(network.second)))
                here[:, o] = miss
                found.append(here)
    return np.array(straight), np.array(flat)


def _used(first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which hidden sums change, and are used."""
    return np.asarray((second != FLAT).any(axis=0) & (first != FLAT).any(axis=1))


def _misses(x: Real, y: Real) -> tuple[Real, Real]:
    """The residuals of y from its nearest line over x, and from its mean."""
    off = y - y.mean()
    along = x - x.mean()
    spread = float(along @ along)
    return off - (float(along @ off) / spread if spread > 0 else 0.0) * along, off
