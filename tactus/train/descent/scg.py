"""Scaled conjugate gradient, the optimiser of the thesis.

M. F. Moller, "A scaled conjugate gradient algorithm for fast supervised learning", Neural Networks
6 (1993), 525-533. The step length comes from the curvature along the direction, measured by a
difference of gradients and kept positive by a scale that grows where the quadratic model of the
error is poor and shrinks where it is good; no line search is needed.
"""

from collections.abc import Callable

import numpy as np

from golden.numbers.real import Real
from tactus.train.descent.objective import Objective

Evaluate = Callable[[Real], tuple[float, Real]]

SIGMA = 1e-4  # length of the difference that measures curvature, for a direction of length 1
SCALE_RANGE = (1e-15, 1e100)


def minimise(evaluate: Evaluate, start: Real, steps: int, tolerance: float = 1e-12) -> Real:
    """The point that SCG reaches from ``start``.

    evaluate: Value and gradient at a point.
    steps: Most steps, each of two evaluations.
    tolerance: Stop when neither the value, relative to itself, nor any coordinate moves by more.
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
            small = np.abs(step * direction).max() < tolerance
            settled = small and abs(new_value - value) <= tolerance * abs(value)
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


def descend(objective: Objective, start: Real, steps: int) -> Real:
    """The point that SCG reaches on a training objective in at most ``steps`` steps."""
    return minimise(objective.evaluate, start, steps)
