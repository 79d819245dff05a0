"""The function that training minimises, with either optimiser, and early stopping."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from golden.numbers.real import Real
from golden.trained.dense import Trained
from golden.trained.mlp import Activation, Mlp


@dataclass(frozen=True)
class Rows:
    """Some rows of the recorded vectors.

    inputs: shape (rows, inputs).
    targets, scale, shape (rows, outputs): ``scale`` is the divisor of an error: the target or a
        full scale.
    """

    inputs: Real
    targets: Real
    scale: Real

    def residuals(self, network: Trained, activation: Activation) -> Real:
        """The scaled errors of a network as a vector."""
        return ((network.process(self.inputs, activation) - self.targets) / self.scale).ravel()


def pack(mlp: Mlp) -> Real:
    """All weights and biases in one vector: w1, b1, w2, b2, row by row."""
    return np.concatenate([mlp.w1.ravel(), mlp.b1, mlp.w2.ravel(), mlp.b2])


def unpack(vector: Real, shape: tuple[int, int, int]) -> Mlp:
    """The inverse of ``pack`` for a network of ``shape`` (inputs, hidden, outputs)."""
    inputs, hidden, outputs = shape
    sizes = np.cumsum([hidden * inputs, hidden, outputs * hidden])
    w1, b1, w2, b2 = np.split(vector, sizes)
    return Mlp(w1.reshape(hidden, inputs), b1, w2.reshape(outputs, hidden), b2)


class EarlyStop(Exception):  # noqa: N818, a signal, not an error
    """Ends a descent whose last points have not lowered the validation error."""


Descend = Callable[["Objective", Real, int], Real]


@dataclass
class Objective:
    """sum((y - t) / scale)**2 + weight_decay * sum(w**2) over the training rows.

    Each point with a lower value than all before is also measured on the validation rows; ``best``
    is the point with the least error there. After ``patience`` such points without a new best one,
    ``EarlyStop`` ends the descent.

    shape: Inputs, hidden nodes and outputs.
    activation: Value and slope of the hidden layer.
    weight_decay: Factor that keeps weights small, and with them Q_j and Y_i.
    """

    shape: tuple[int, int, int]
    activation: Activation
    training: Rows
    validation: Rows
    weight_decay: float
    patience: int
    best: Real | None = None
    _lowest: float = field(default=np.inf, init=False)
    _least_validation: float = field(default=np.inf, init=False)
    _in_vain: int = field(default=0, init=False)

    def search(self, descend: Descend, start: Real, steps: int) -> Real:
        """The best point of a descent from ``start`` with at most ``steps`` evaluations."""
        with suppress(EarlyStop):
            descend(self, start, steps)
        return start if self.best is None else self.best

    def network(self, vector: Real) -> Trained:
        """The network whose weights and biases are ``vector``."""
        return unpack(vector, self.shape)

    def residuals(self, vector: Real) -> Real:
        """Scaled errors, then the weights times the root of the decay."""
        network = self.network(vector)
        errors = self.training.residuals(network, self.activation)
        result = np.concatenate([errors, np.sqrt(self.weight_decay) * vector])
        value = float(result @ result)
        if value < self._lowest:
            self._lowest = value
            held_back = self.validation.residuals(network, self.activation)
            validation = float(held_back @ held_back)
            if validation < self._least_validation:
                self._least_validation = validation
                self._in_vain = 0
                self.best = vector.copy()
            else:
                self._in_vain += 1
                if self._in_vain == self.patience:
                    raise EarlyStop
        return result

    def jacobian(self, vector: Real) -> Real:
        """Derivatives of the residuals, shape (residuals, weights)."""
        inputs, hidden, outputs = self.shape
        mlp = unpack(vector, self.shape)
        x = self.training.inputs
        r, slope = self.activation(x @ mlp.w1.T + mlp.b1)
        back = mlp.w2 * slope[:, np.newaxis, :]
        first_layer = hidden * inputs + hidden
        result = np.zeros((len(x), outputs, len(vector)))
        result[:, :, : hidden * inputs] = (
            back[..., np.newaxis] * x[:, np.newaxis, np.newaxis, :]
        ).reshape(len(x), outputs, -1)
        result[:, :, hidden * inputs : first_layer] = back
        for i in range(outputs):
            at = first_layer + i * hidden
            result[:, i, at : at + hidden] = r
            result[:, i, first_layer + outputs * hidden + i] = 1
        result /= self.training.scale[:, :, np.newaxis]
        decay = np.sqrt(self.weight_decay) * np.eye(len(vector))
        return np.concatenate([result.reshape(-1, len(vector)), decay])

    def evaluate(self, vector: Real) -> tuple[float, Real]:
        """Value and gradient; the gradient comes from propagating the errors back."""
        residuals = self.residuals(vector)
        mlp = unpack(vector, self.shape)
        x, scale = self.training.inputs, self.training.scale
        r, slope = self.activation(x @ mlp.w1.T + mlp.b1)
        errors = residuals[: scale.size].reshape(scale.shape) / scale
        back = (errors @ mlp.w2) * slope
        gradient = pack(Mlp(back.T @ x, back.sum(axis=0), errors.T @ r, errors.sum(axis=0)))
        return float(residuals @ residuals), 2 * (gradient + self.weight_decay * vector)


def probabilities(logits: Real) -> Real:
    """The probability of each class for each row (softmax of the logits), shape (rows, classes)."""
    parts = np.exp(logits - logits.max(axis=1, keepdims=True))
    return parts / parts.sum(axis=1, keepdims=True)


def entropies(logits: Real, targets: Real) -> Real:
    """The cross-entropy of each row with one-hot targets, shape (rows,)."""
    own = (logits * targets).sum(axis=1, keepdims=True)
    # One term of the sum is exp(0), so that no result is below 0.
    return np.logaddexp.reduce(logits - own, axis=1)


def curvature_roots(parts: Real) -> Real:
    """Roots of the second derivatives by the logits, shape (rows, classes, classes).

    With the probabilities p of a row, these are diag(p) - p p' = S S', with
    S = diag(sqrt p) - p sqrt(p)'. The result is S' of each row.
    """
    roots = np.sqrt(parts)[:, np.newaxis, :]
    return np.eye(parts.shape[1]) * roots - np.swapaxes(roots, 1, 2) * parts[:, np.newaxis, :]
