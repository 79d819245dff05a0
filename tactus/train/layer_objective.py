"""The functions that training minimises for networks of any depth, and for classes."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from golden.numbers.real import Real
from golden.trained.dense import Trained, layers_of, unpacked
from golden.trained.mlp import Activation, tanh
from tactus.train.descent.objective import (
    Objective,
    Rows,
    curvature_roots,
    entropies,
    probabilities,
)


class LayeredObjective(Objective):
    """The function that a descent minimises; see ``Objective``.

    like: A network with the layers that are trained.
    **settings: The parameters of ``Objective``, except the shape and the activation.
    """

    def __init__(self, like: Trained, **settings: Any):
        inputs, *hidden, outputs = like.shape
        super().__init__(shape=(inputs, sum(hidden), outputs), activation=tanh, **settings)
        self.like = like

    def network(self, vector: Real) -> Trained:
        return unpacked(vector, self.like)

    def jacobian(self, vector: Real) -> Real:
        scale = self.training.scale
        rows, outputs = scale.shape
        back = np.broadcast_to(np.eye(outputs), (rows, outputs, outputs))
        result = self._derivatives(self.network(vector), back) / scale[:, :, np.newaxis]
        decay = np.sqrt(self.weight_decay) * np.eye(len(vector))
        return np.concatenate([result.reshape(-1, len(vector)), decay])

    def evaluate(self, vector: Real) -> tuple[float, Real]:
        residuals = self.residuals(vector)
        scale = self.training.scale
        back = residuals[: scale.size].reshape(scale.shape) / scale
        gradient = self._gradient(self.network(vector), back)
        return float(residuals @ residuals), 2 * (gradient + self.weight_decay * vector)

    def curvature(self, vector: Real) -> Real:
        """The Gauss-Newton matrix of the value, by the faster way to it."""
        scale = self.training.scale
        if scale.shape[1] == 1:
            slopes = self._derivatives(self.network(vector), 1 / scale[..., np.newaxis])[:, 0]
            hessian = slopes.T @ slopes
        else:
            hessian = self.value_gradient_hessian(vector)[1]
        return 2 * (hessian + self.weight_decay * np.eye(len(vector)))

    def value_gradient_hessian(self, vector: Real) -> tuple[Real, Real]:
        """Half the gradient of the squares, without the decay, and half their Hessian.

        The Hessian is that of Gauss and Newton, J' J for the derivatives J of the residuals. The
        derivative by a weight is a product of what comes in front of the weight and of what follows
        it. So the sums over the outputs and over the rows are two smaller products, and J itself,
        which would be large, is not needed.
        """
        network, scale = self.network(vector), self.training.scale
        ones = np.ones((len(scale), 1))
        parts = [
            (back, np.concatenate([inputs, ones], axis=1))
            for inputs, back in self._backward(network, np.eye(scale.shape[1]) / scale[..., None])
        ]
        rows = []
        for back, before in parts:
            blocks = []
            for other, earlier in parts:
                nodes = np.einsum("roa,rob->rab", back, other, optimize=True)
                inputs = before[:, :, np.newaxis] * earlier[:, np.newaxis, :]
                block = nodes.reshape(len(scale), -1).T @ inputs.reshape(len(scale), -1)
                shape = back.shape[2], other.shape[2], before.shape[1], earlier.shape[1]
                block = np.swapaxes(block.reshape(shape), 1, 2)
                blocks.append(block.reshape(shape[0] * shape[2], -1))
            rows.append(np.concatenate(blocks, axis=1))
        # So far the bias of a node follows its weights; a packed vector has all biases behind them.
        order, at = [], 0
        for back, before in parts:
            nodes, inputs = back.shape[2], before.shape[1]
            places = at + np.arange(nodes * inputs).reshape(nodes, inputs)
            order += [places[:, :-1].ravel(), places[:, -1]]
            at += nodes * inputs
        places = np.concatenate(order)
        errors = (
            network.process(self.training.inputs, self.activation) - self.training.targets
        ) / (scale**2)
        hessian: Real = np.concatenate(rows)[np.ix_(places, places)]
        return self._gradient(network, errors), hessian

    def _derivatives(self, network: Trained, back: Real) -> Real:
        """Derivatives of every residual of a row by the weights, shape (rows, residuals, weights).

        ``back`` has those by the outputs, shape (rows, residuals, outputs).
        """
        sums = self._backward(network, back)
        size = sum(own.shape[2] * (inputs.shape[1] + 1) for inputs, own in sums)
        found, at = np.empty((*back.shape[:2], size)), 0
        for inputs, own in sums:
            shape = *own.shape, inputs.shape[1]
            biases = at + shape[2] * shape[3]
            # A view, so that the products of many rows are written once.
            weights = found[..., at:biases].reshape(shape)
            np.multiply(own[..., np.newaxis], inputs[:, np.newaxis, np.newaxis, :], out=weights)
            at = biases + shape[2]
            found[..., biases:at] = own
        return found

    def _gradient(self, network: Trained, back: Real) -> Real:
        """The sum over the rows of the derivatives by the weights.

        ``back`` has those by the outputs, shape (rows, outputs).
        """
        found: list[Real] = []
        for inputs, own in self._backward(network, back):
            found += [(own.T @ inputs).ravel(), own.sum(axis=0)]
        return np.concatenate(found)

    def _backward(self, network: Trained, back: Real) -> list[tuple[Real, Real]]:
        """For each layer its inputs, and the derivatives by its sums.

        ``back`` has those by the outputs, shape (rows, outputs) or (rows, residuals, outputs).
        """
        value, forward = self.training.inputs, []
        for layer in layers_of(network):
            inputs = value
            value, slope = layer.activate(inputs @ layer.weights.T + layer.biases, self.activation)
            forward.append((layer, inputs, slope))
        found: list[tuple[Real, Real]] = []
        for layer, inputs, slope in reversed(forward):
            back = back * (slope if back.ndim == slope.ndim else slope[:, np.newaxis, :])
            found.insert(0, (inputs, back))
            back = back @ layer.weights
        return found


@dataclass(frozen=True)
class LabelledRows(Rows):
    """Rows with one-hot targets.

    The outputs are logits, and the residual of a row is the root of its cross-entropy. So the sum
    of squares is the cross-entropy.
    """

    def residuals(self, network: Trained, activation: Activation) -> Real:
        """The residual of each row."""
        logits = network.process(self.inputs, activation)
        return np.sqrt(entropies(logits, self.targets))


class ClassObjective(LayeredObjective):
    """The cross-entropy of labelled rows, plus ``weight_decay`` times the sum of squared weights.

    See ``LayeredObjective``; ``training`` and ``validation`` are ``LabelledRows``.
    """

    def curvature(self, vector: Real) -> Real:
        """The generalised Gauss-Newton matrix of the value, shape (weights, weights).

        The second derivatives by the logits are carried to the weights; see ``curvature_roots``.
        """
        network = self.network(vector)
        back = curvature_roots(self._probabilities(network))
        slopes = self._derivatives(network, back).reshape(-1, len(vector))
        return slopes.T @ slopes + 2 * self.weight_decay * np.eye(len(vector))

    def evaluate(self, vector: Real) -> tuple[float, Real]:
        residuals = self.residuals(vector)
        network = self.network(vector)
        gradient = self._gradient(network, self._too_probable(network))
        return float(residuals @ residuals), gradient + 2 * self.weight_decay * vector

    def _too_probable(self, network: Trained) -> Real:
        """The derivative of the cross-entropy by the logits: probability minus target."""
        return self._probabilities(network) - self.training.targets

    def _probabilities(self, network: Trained) -> Real:
        """The probability of each class for each training row, shape (rows, classes)."""
        return probabilities(network.process(self.training.inputs, self.activation))


# The first damping and the least one, as a part of the largest curvature along a weight.
FIRST_DAMPING = 1e-2
LEAST_DAMPING = 1e-12
# A descent ends when a step would lower the value by less than this part of it.
TOLERANCE = 1e-12


def descend(objective: LayeredObjective, start: Real, steps: int) -> Real:
    """Levenberg-Marquardt by normal equations, for classes and for many rows.

    MINPACK's, which trains networks for numbers on fewer rows, minimises a sum of squares, and
    takes the curvature of a square from the slope of its residual alone. The cross-entropy of a row
    is no such square: taken as one, each step overshoots, and weights grow large before the
    validation error falls. So the curvature here is that of the cross-entropy by the logits,
    carried to the weights by the derivatives of the logits (the generalised Gauss-Newton matrix: N.
    N. Schraudolph, "Fast curvature matrix-vector products for second-order gradient descent",
    Neural Computation 14 (2002), 1723-1738).

    The damping follows K. Madsen, H. B. Nielsen and O. Tingleff, "Methods for non-linear least
    squares problems", Technical University of Denmark, second edition, 2004, algorithm 3.16.

    steps: The most evaluations.
    """
    point = start
    value, gradient = objective.evaluate(point)
    curvature = objective.curvature(point)
    damping, growth = FIRST_DAMPING * float(curvature.diagonal().max()), 2.0
    for _ in range(steps - 1):
        damping = max(damping, LEAST_DAMPING * float(curvature.diagonal().max()))
        step = -np.linalg.solve(curvature + damping * np.eye(len(point)), gradient)
        expected = -float(step @ (gradient + curvature @ step / 2))
        if expected <= TOLERANCE * value:
            break
        found, slope = objective.evaluate(point + step)
        gain = (value - found) / expected
        if gain > 0:
            point, value, gradient = point + step, found, slope
            curvature = objective.curvature(point)
            damping *= max(1 / 3, 1 - (2 * gain - 1) ** 3)
            growth = 2.0
        else:
            damping *= growth
            growth *= 2
    return point
