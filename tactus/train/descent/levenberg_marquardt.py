"""Levenberg-Marquardt: least squares over all weights at once, through SciPy's MINPACK."""

from scipy.optimize import least_squares

from golden.numbers.real import Real
from tactus.train.descent.objective import Objective


def descend(objective: Objective, start: Real, steps: int) -> Real:
    """The point that the descent reaches with at most ``steps`` evaluations."""
    found = least_squares(
        objective.residuals, start, objective.jacobian, method="lm", max_nfev=steps
    )
    return found.x
