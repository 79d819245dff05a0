"""Levenberg-Marquardt on the normal equations, with early stopping by other rows."""

from collections.abc import Callable

import numpy as np

from golden.numbers.real import Real
from tactus.train.splines.objective import SplineObjective

# The damping as a part of the diagonal: at the start, its least, and that at which no step helps.
DAMPING, LEAST, MOST = 1e-3, 1e-12, 1e8
UP, DOWN = 4.0, 5.0
# A descent ends when a step gains less than this part of the function.
SETTLED = 1e-5
ROUNDING = 1e-12


def descend(objective: SplineObjective, start: Real, steps: int) -> Real:
    """The point that at most ``steps`` evaluations reach from ``start``."""
    return _descended(objective, start, steps, lambda point: False)


def stopped_early(
    objective: SplineObjective, start: Real, steps: int, validation: SplineObjective, patience: int
) -> Real:
    """The point of a descent that has the least error on the rows of ``validation``.

    After ``patience`` points without a new best one the descent ends.
    """
    best, least, in_vain = start, np.inf, 0

    def seen(point: Real) -> bool:
        nonlocal best, least, in_vain
        error = float((validation.errors(point) ** 2).sum())
        if error < least:
            best, least, in_vain = point, error, 0
        else:
            in_vain += 1
        return in_vain >= patience

    _descended(objective, start, steps, seen)
    return best


def _descended(
    objective: SplineObjective, start: Real, steps: int, over: Callable[[Real], bool]
) -> Real:
    point, damping = start, DAMPING
    value, gradient, hessian = objective.value_gradient_hessian(point)
    for _ in range(steps):
        scale = hessian.diagonal()
        held = hessian + np.diag(damping * scale + ROUNDING * scale.max())
        moved = point - np.linalg.solve(held, gradient)
        new = objective.value(moved)
        if not new < value:
            damping *= UP
            if damping > MOST:
                break
            continue
        settled = value - new < SETTLED * value
        point, damping = moved, max(damping / DOWN, LEAST)
        if over(point) or settled:
            break
        value, gradient, hessian = objective.value_gradient_hessian(point)
    return point
