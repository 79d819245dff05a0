"""What the outputs of a network cost on rows: squared errors, or for classes the cross-entropy."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from golden.numbers.real import Real
from tactus.train.descent.cross_entropy import curvature_roots, entropies, probabilities
from tactus.train.descent.objective import Rows

# Below this a probability counts as this, so that it has an inverse.
LEAST_PROBABILITY = 1e-300


class Loss(Protocol):
    """A sum of squares over rows, and what a descent has to know about it."""

    def errors(self, outputs: Real, rows: Rows) -> Real:
        """The numbers whose squares add up to the loss, some for each row."""

    def value_gradient_hessian(self, outputs: Real, rows: Rows) -> tuple[Real, Real]:
        """Misses m and roots R of each row, shapes (rows, n) and (rows, n, outputs).

        By the outputs, half the gradient of the loss is R' m, and half its curvature is R' R.
        """


@dataclass(frozen=True)
class Squares:
    """The squares of the scaled errors: ``sum(((y - t) / scale)**2)``."""

    def errors(self, outputs: Real, rows: Rows) -> Real:
        return np.asarray((outputs - rows.targets) / rows.scale)

    def value_gradient_hessian(self, outputs: Real, rows: Rows) -> tuple[Real, Real]:
        weight = 1 / rows.scale
        return self.errors(outputs, rows), weight[..., np.newaxis] * np.eye(weight.shape[1])


SQUARES = Squares()


@dataclass(frozen=True)
class CrossEntropy:
    """The cross-entropy of outputs that are logits, with one-hot targets.

    Its curvature by the logits is carried to the parameters by their first derivatives alone (the
    generalised Gauss-Newton matrix), as for MLPs in ``tactus.train.class_descent``.
    """

    def errors(self, outputs: Real, rows: Rows) -> Real:
        return np.sqrt(entropies(outputs, rows.targets))[:, np.newaxis]

    def value_gradient_hessian(self, outputs: Real, rows: Rows) -> tuple[Real, Real]:
        # The gradient is S m with m = (p - t) / sqrt(p), since sqrt(p)' m is 0.
        parts = np.maximum(probabilities(outputs), LEAST_PROBABILITY)
        misses = (parts - rows.targets) / np.sqrt(parts)
        return misses / np.sqrt(2), curvature_roots(parts) / np.sqrt(2)
