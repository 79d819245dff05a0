"""Levenberg-Marquardt by normal equations, for classes and for many rows.

MINPACK's, which trains networks for numbers on fewer rows, minimises a sum of squares, and takes
the curvature of a square from the slope of its residual alone. The cross-entropy of a row is no
such square: taken as one, each step overshoots, and weights grow large before the validation error
falls. So the curvature here is that of the cross-entropy by the logits, carried to the weights by
the derivatives of the logits (the generalised Gauss-Newton matrix: N. N. Schraudolph, "Fast
curvature matrix-vector products for second-order gradient descent", Neural Computation 14 (2002),
1723-1738).

The damping follows K. Madsen, H. B. Nielsen and O. Tingleff, "Methods for non-linear least squares
problems", Technical University of Denmark, second edition, 2004, algorithm 3.16.
"""

import numpy as np

from golden.numbers.real import Real
from tactus.train.layer_objective import LayeredObjective

# The first damping and the least one, as a part of the largest curvature along a weight.
FIRST_DAMPING = 1e-2
LEAST_DAMPING = 1e-12
# A descent ends when a step would lower the value by less than this part of it.
TOLERANCE = 1e-12


def descend(objective: LayeredObjective, start: Real, steps: int) -> Real:
    """The point that the descent reaches with at most ``steps`` evaluations."""
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
