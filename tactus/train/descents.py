"""The descents: each gives the point that it reaches from a start in at most so many steps."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from golden.numbers.real import Real
from tactus.train.objective import Objective

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
