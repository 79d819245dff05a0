"""The functions that training minimises, early stopping, and the descents.

Each descent gives the point that it reaches from a start in at most so many steps.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from golden.numbers.real import Real
from golden.trained.dense import Activation, DenseNetwork, unpacked


@dataclass(frozen=True)
class Rows:
    """Some rows of the recorded vectors, and what the outputs of a network cost on them.

    inputs: shape (rows, inputs).
    targets, scale, shape (rows, outputs): ``scale`` is the divisor of an error: the target or a
        full scale.
    labelled: Whether the outputs are logits of classes, and the targets one-hot. Then the loss is
        the cross-entropy; otherwise it is the sum of the squares of the scaled errors.
    """

    inputs: Real
    targets: Real
    scale: Real
    labelled: bool = field(default=False, kw_only=True)

    def errors(self, outputs: Real) -> Real:
        """The numbers whose squares add up to the loss, shape (rows, n)."""
        if not self.labelled:
            return np.asarray((outputs - self.targets) / self.scale)
        own = (outputs * self.targets).sum(axis=1, keepdims=True)
        # One term of the sum is exp(0), so that no entropy is below 0.
        return np.sqrt(np.logaddexp.reduce(outputs - own, axis=1))[:, np.newaxis]

    def slopes(self, outputs: Real) -> Real:
        """Half the gradient of the loss by the outputs, shape (rows, outputs)."""
        if self.labelled:
            return (probabilities(outputs) - self.targets) / 2
        return self.errors(outputs) / self.scale

    def roots(self, outputs: Real) -> Real:
        """R of each row, shape (rows, n, outputs): half the curvature by the outputs is R' R.

        With the probabilities p of a row, the curvature of the cross-entropy is diag(p) - p p' =
        S S', with S = diag(sqrt p) - p sqrt(p)'.
        """
        if not self.labelled:
            return (1 / self.scale)[..., np.newaxis] * np.eye(self.scale.shape[1])
        parts = probabilities(outputs)
        found = np.sqrt(parts)[:, np.newaxis, :]
        back = np.swapaxes(found, 1, 2) * parts[:, np.newaxis, :]
        return np.asarray(np.eye(parts.shape[1]) * found - back) / np.sqrt(2)


def probabilities(logits: Real) -> Real:
    """The probability of each class for each row (softmax of the logits), shape (rows, classes)."""
    parts = np.exp(logits - logits.max(axis=1, keepdims=True))
    return parts / parts.sum(axis=1, keepdims=True)


class EarlyStop(Exception):  # noqa: N818, a signal, not an error
    """Ends a descent whose last points have not lowered the validation error."""


Descend = Callable[[Any, Real, int], Real]


@dataclass
class Watched:
    """A function of the weights of a network; it keeps the point that validation rows choose.

    Each point with a lower value than all before is also measured on the validation rows; ``best``
    is the point with the least error there. After ``patience`` such points without a new best one,
    ``EarlyStop`` ends the descent.

    like: A network with the layers that are trained.
    """

    like: Any
    training: Rows
    validation: Rows
    patience: int
    best: Real | None = field(default=None, init=False)
    _lowest: float = field(default=np.inf, init=False)
    _least_validation: float = field(default=np.inf, init=False)
    _in_vain: int = field(default=0, init=False)

    def search(self, descend: Descend, start: Real, steps: int) -> Real:
        """The best point of a descent from ``start`` with at most ``steps`` evaluations."""
        with suppress(EarlyStop):
            descend(self, start, steps)
        return start if self.best is None else self.best

    def outputs(self, vector: Real, inputs: Real) -> Real:
        """The outputs of the network at a point."""
        raise NotImplementedError

    def note(self, value: float, vector: Real) -> None:
        """Take notice of a point that a descent has come to."""
        if not value < self._lowest:
            return
        self._lowest = value
        errors = self.validation.errors(self.outputs(vector, self.validation.inputs)).ravel()
        validation = float(errors @ errors)
        if validation < self._least_validation:
            self._least_validation, self._in_vain, self.best = validation, 0, vector.copy()
            return
        self._in_vain += 1
        if self._in_vain == self.patience:
            raise EarlyStop


@dataclass
class Objective(Watched):
    """The loss on the training rows, plus ``weight_decay * sum(w**2)``.

    activation: What the hardware computes in the place of tanh: value and slope.
    weight_decay: Factor that keeps weights small, and with them Q_j and Y_i.
    """

    activation: Activation
    weight_decay: float
    # A descent by normal equations ends when less than this part of the value can be gained.
    settled = 1e-12

    def network(self, vector: Real) -> DenseNetwork:
        return unpacked(vector, self.like)

    def outputs(self, vector: Real, inputs: Real) -> Real:
        return self.network(vector).process(inputs, self.activation)

    def residuals(self, vector: Real) -> Real:
        """The errors of the loss, then the weights times the root of the decay."""
        errors = self.training.errors(self.outputs(vector, self.training.inputs))
        result = np.concatenate([errors.ravel(), np.sqrt(self.weight_decay) * vector])
        self.note(float(result @ result), vector)
        return result

    def value(self, vector: Real) -> float:
        residuals = self.residuals(vector)
        return float(residuals @ residuals)

    def jacobian(self, vector: Real) -> Real:
        """Derivatives of the residuals of squares, shape (residuals, weights)."""
        scale = self.training.scale
        found, at = np.empty((*scale.shape, len(vector))), 0
        ones = np.broadcast_to(np.eye(scale.shape[1]), (*scale.shape, scale.shape[1]))
        for inputs, own in self._backward(vector, lambda _: ones):
            shape = *own.shape, inputs.shape[1]
            biases = at + shape[2] * shape[3]
            # A view, so that the products of many rows are written once.
            weights = found[..., at:biases].reshape(shape)
            np.multiply(own[..., np.newaxis], inputs[:, np.newaxis, np.newaxis, :], out=weights)
            at = biases + shape[2]
            found[..., biases:at] = own
        decay = np.sqrt(self.weight_decay) * np.eye(len(vector))
        return np.concatenate([(found / scale[..., np.newaxis]).reshape(-1, len(vector)), decay])

    def evaluate(self, vector: Real) -> tuple[float, Real]:
        """Value and gradient; the gradient comes from propagating the errors back."""
        return self.value(vector), 2 * self._gradient(vector)

    def gradient_hessian(self, vector: Real) -> tuple[Real, Real]:
        """Half the gradient of the value, and half its Hessian.

        The Hessian is that of Gauss and Newton: the curvature of the loss by the outputs, carried
        to the weights by the derivatives of the outputs. The derivative by a weight is a product
        of what comes in front of the weight and of what follows it. So the sums over the outputs
        and over the rows are two smaller products, and the Jacobian, which would be large, is not
        needed.
        """
        count = len(self.training.inputs)
        parts = [
            (back, np.concatenate([inputs, np.ones((count, 1))], axis=1))
            for inputs, back in self._backward(vector, self.training.roots)
        ]
        rows = []
        for back, before in parts:
            blocks = []
            for other, earlier in parts:
                nodes = np.einsum("roa,rob->rab", back, other, optimize=True)
                inputs = before[:, :, np.newaxis] * earlier[:, np.newaxis, :]
                block = nodes.reshape(count, -1).T @ inputs.reshape(count, -1)
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
        hessian: Real = np.concatenate(rows)[np.ix_(places, places)]
        hessian += self.weight_decay * np.eye(len(vector))
        return self._gradient(vector), hessian

    def _gradient(self, vector: Real) -> Real:
        """Half the gradient of the value."""
        found: list[Real] = []
        for inputs, own in self._backward(vector, self.training.slopes):
            found += [(own.T @ inputs).ravel(), own.sum(axis=0)]
        return np.concatenate(found) + self.weight_decay * vector

    def _backward(
        self, vector: Real, by_outputs: Callable[[Real], Real]
    ) -> list[tuple[Real, Real]]:
        """For each layer its inputs on the training rows, and the derivatives by its sums.

        ``by_outputs`` makes those by the outputs of the outputs, shape (rows, outputs) or (rows,
        residuals, outputs).
        """
        value, forward = self.training.inputs, []
        for layer in self.network(vector).layers:
            inputs = value
            value, slope = layer.activate(layer.sums(inputs), self.activation)
            forward.append((layer, inputs, slope))
        back, found = by_outputs(value), list[tuple[Real, Real]]()
        for layer, inputs, slope in reversed(forward):
            back = back * (slope if back.ndim == slope.ndim else slope[:, np.newaxis, :])
            found.insert(0, (inputs, back))
            back = back @ layer.weights
        return found


def levenberg_marquardt(objective: Objective, start: Real, steps: int) -> Real:
    """Least squares over all weights at once, through SciPy's MINPACK."""
    found = least_squares(
        objective.residuals, start, objective.jacobian, method="lm", max_nfev=steps
    )
    return found.x


# The first damping and the least one, as a part of the largest curvature along a weight.
FIRST_DAMPING = 1e-2
LEAST_DAMPING = 1e-12


def normal_equations(objective: Any, start: Real, steps: int) -> Real:
    """Levenberg-Marquardt by normal equations, for classes, many rows and learned functions.

    MINPACK's, which trains networks for numbers on fewer rows, minimises a sum of squares, and
    takes the curvature of a square from the slope of its residual alone. The cross-entropy of a row
    is no such square: taken as one, each step overshoots, and weights grow large before the
    validation error falls. So the curvature here is that of the cross-entropy by the logits,
    carried to the weights by the derivatives of the logits (the generalised Gauss-Newton matrix: N.
    N. Schraudolph, "Fast curvature matrix-vector products for second-order gradient descent",
    Neural Computation 14 (2002), 1723-1738).

    The damping follows K. Madsen, H. B. Nielsen and O. Tingleff, "Methods for non-linear least
    squares problems", Technical University of Denmark, second edition, 2004, algorithm 3.16.

    objective: An ``Objective`` or a ``SplineObjective``.
    steps: The most evaluations.
    """
    point, growth = start, 2.0
    value = objective.value(point)
    gradient, curvature = objective.gradient_hessian(point)
    damping = FIRST_DAMPING * float(curvature.diagonal().max())
    for _ in range(steps - 1):
        damping = max(damping, LEAST_DAMPING * float(curvature.diagonal().max()))
        step = -np.linalg.solve(curvature + damping * np.eye(len(point)), gradient)
        expected = -float(step @ (2 * gradient + curvature @ step))
        if expected <= objective.settled * value:
            break
        new = objective.value(point + step)
        gain = (value - new) / expected
        if gain > 0:
            point, value = point + step, new
            gradient, curvature = objective.gradient_hessian(point)
            damping *= max(1 / 3, 1 - (2 * gain - 1) ** 3)
            growth = 2.0
        else:
            damping *= growth
            growth *= 2
    return point


# SCG ends when a step changes the value by less than this part of it, and no coordinate by more.
TOLERANCE = 1e-12
SIGMA = 1e-4  # length of the difference that measures curvature, for a direction of length 1
SCALE_RANGE = (1e-15, 1e100)


def scg(objective: Any, start: Real, steps: int) -> Real:
    """Scaled conjugate gradient, the optimiser of the thesis.

    M. F. Moller, "A scaled conjugate gradient algorithm for fast supervised learning", Neural
    Networks 6 (1993), 525-533. The step length comes from the curvature along the direction,
    measured by a difference of gradients and kept positive by a scale that grows where the
    quadratic model of the error is poor and shrinks where it is good; no line search is needed.

    objective: Its ``evaluate`` gives value and gradient at a point.
    steps: Most steps, each of two evaluations.
    """
    evaluate, point = objective.evaluate, start
    value, gradient = evaluate(point)
    direction = -gradient
    scale, curvature = 1.0, 0.0
    fresh = True  # the direction is new, so its curvature must be measured
    successes = 0
    for _ in range(steps):
        slope = float(direction @ gradient)
        if slope >= 0:
            direction, fresh = -gradient, True
            slope = float(direction @ gradient)
        length = float(direction @ direction)
        if length == 0:
            break
        if fresh:
            sigma = SIGMA / np.sqrt(length)
            ahead = evaluate(point + sigma * direction)[1]
            curvature = float(direction @ (ahead - gradient)) / sigma
        scaled = curvature + scale * length
        if scaled <= 0:
            scaled = scale * length
            scale -= curvature / length
        step = -slope / scaled
        candidate = point + step * direction
        new_value, new_gradient = evaluate(candidate)
        # The part of the decrease predicted by the quadratic model that was really reached.
        quality = 2 * (new_value - value) / (step * slope)
        fresh = quality >= 0
        if fresh:
            small = np.abs(step * direction).max() < TOLERANCE
            settled = small and abs(new_value - value) <= TOLERANCE * abs(value)
            old_gradient, point, value, gradient = gradient, candidate, new_value, new_gradient
            successes += 1
            if settled:
                break
            if successes % len(start) == 0:
                direction = -gradient
            else:
                share = float((old_gradient - gradient) @ gradient) / slope
                direction = share * direction - gradient
        # A step to infinity or NaN gives no quality. It is refused, and the scale grows.
        if not quality >= 0.25:
            scale = min(4 * scale, SCALE_RANGE[1])
        elif quality > 0.75:
            scale = max(scale / 2, SCALE_RANGE[0])
    return point


OPTIMISERS = {"levenberg-marquardt": levenberg_marquardt, "scg": scg}
