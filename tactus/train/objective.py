"""The functions that training minimises, early stopping, and the descents.

Each descent gives the point that it reaches from a start in at most so many steps.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares

from golden.numbers.real import Real
from golden.trained.dense import Activation, DenseNetwork, unpacked


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

    def residuals(self, network: DenseNetwork, activation: Activation) -> Real:
        """The scaled errors of a network as a vector."""
        return ((network.process(self.inputs, activation) - self.targets) / self.scale).ravel()


@dataclass(frozen=True)
class LabelledRows(Rows):
    """Rows with one-hot targets.

    The outputs are logits, and the residual of a row is the root of its cross-entropy. So the sum
    of squares is the cross-entropy.
    """

    def residuals(self, network: DenseNetwork, activation: Activation) -> Real:
        """The residual of each row."""
        logits = network.process(self.inputs, activation)
        return np.sqrt(entropies(logits, self.targets))


class EarlyStop(Exception):  # noqa: N818, a signal, not an error
    """Ends a descent whose last points have not lowered the validation error."""


Descend = Callable[["Objective", Real, int], Real]


@dataclass
class Objective:
    """sum((y - t) / scale)**2 + weight_decay * sum(w**2) over the training rows.

    Each point with a lower value than all before is also measured on the validation rows; ``best``
    is the point with the least error there. After ``patience`` such points without a new best one,
    ``EarlyStop`` ends the descent.

    like: A network with the layers that are trained.
    activation: What the hardware computes in the place of tanh: value and slope.
    weight_decay: Factor that keeps weights small, and with them Q_j and Y_i.
    """

    like: DenseNetwork
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

    def network(self, vector: Real) -> DenseNetwork:
        return unpacked(vector, self.like)

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
        scale = self.training.scale
        rows, outputs = scale.shape
        back = np.broadcast_to(np.eye(outputs), (rows, outputs, outputs))
        result = self._derivatives(self.network(vector), back) / scale[:, :, np.newaxis]
        decay = np.sqrt(self.weight_decay) * np.eye(len(vector))
        return np.concatenate([result.reshape(-1, len(vector)), decay])

    def evaluate(self, vector: Real) -> tuple[float, Real]:
        """Value and gradient; the gradient comes from propagating the errors back."""
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

    def _derivatives(self, network: DenseNetwork, back: Real) -> Real:
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

    def _gradient(self, network: DenseNetwork, back: Real) -> Real:
        """The sum over the rows of the derivatives by the weights.

        ``back`` has those by the outputs, shape (rows, outputs).
        """
        found: list[Real] = []
        for inputs, own in self._backward(network, back):
            found += [(own.T @ inputs).ravel(), own.sum(axis=0)]
        return np.concatenate(found)

    def _backward(self, network: DenseNetwork, back: Real) -> list[tuple[Real, Real]]:
        """For each layer its inputs, and the derivatives by its sums.

        ``back`` has those by the outputs, shape (rows, outputs) or (rows, residuals, outputs).
        """
        value, forward = self.training.inputs, []
        for layer in network.layers:
            inputs = value
            value, slope = layer.activate(inputs @ layer.weights.T + layer.biases, self.activation)
            forward.append((layer, inputs, slope))
        found: list[tuple[Real, Real]] = []
        for layer, inputs, slope in reversed(forward):
            back = back * (slope if back.ndim == slope.ndim else slope[:, np.newaxis, :])
            found.insert(0, (inputs, back))
            back = back @ layer.weights
        return found


class ClassObjective(Objective):
    """The cross-entropy of labelled rows, plus ``weight_decay`` times the sum of squared weights.

    ``training`` and ``validation`` are ``LabelledRows``.
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
        # The derivative of the cross-entropy by the logits is probability minus target.
        gradient = self._gradient(network, self._probabilities(network) - self.training.targets)
        return float(residuals @ residuals), gradient + 2 * self.weight_decay * vector

    def _probabilities(self, network: DenseNetwork) -> Real:
        """The probability of each class for each training row, shape (rows, classes)."""
        return probabilities(network.process(self.training.inputs, self.activation))


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


Evaluate = Callable[[Real], tuple[float, Real]]


def levenberg_marquardt(objective: Objective, start: Real, steps: int) -> Real:
    """Least squares over all weights at once, through SciPy's MINPACK."""
    found = least_squares(
        objective.residuals, start, objective.jacobian, method="lm", max_nfev=steps
    )
    return found.x


# The first damping and the least one, as a part of the largest curvature along a weight.
FIRST_DAMPING = 1e-2
LEAST_DAMPING = 1e-12
# A descent ends when a step would change the value by less than this part of it, and SCG only when
# no coordinate moves by more either.
TOLERANCE = 1e-12


def normal_equations(objective: Objective, start: Real, steps: int) -> Real:
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


SIGMA = 1e-4  # length of the difference that measures curvature, for a direction of length 1
SCALE_RANGE = (1e-15, 1e100)


def minimise(evaluate: Evaluate, start: Real, steps: int) -> Real:
    """The point that SCG reaches from ``start``.

    M. F. Moller, "A scaled conjugate gradient algorithm for fast supervised learning", Neural
    Networks 6 (1993), 525-533. The step length comes from the curvature along the direction,
    measured by a difference of gradients and kept positive by a scale that grows where the
    quadratic model of the error is poor and shrinks where it is good; no line search is needed.

    evaluate: Value and gradient at a point.
    steps: Most steps, each of two evaluations.
    """
    point = start
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


def scg(objective: Objective, start: Real, steps: int) -> Real:
    """Scaled conjugate gradient, the optimiser of the thesis; see ``minimise``."""
    return minimise(objective.evaluate, start, steps)


OPTIMISERS = {"levenberg-marquardt": levenberg_marquardt, "scg": scg}
