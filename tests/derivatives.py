"""Checks the derivatives of an objective against differences."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from golden.numbers.real import Real
from tactus.train.objective import Objective


def differences(function: Callable[[Real], Any], point: Real) -> Real:
    """The central differences of a function along each coordinate, on the first axis."""
    steps = 1e-6 * np.eye(len(point))
    return np.array([(function(point + s) - function(point - s)) / 2e-6 for s in steps])


def check_derivatives(aim: Objective, point: Real) -> None:
    """Gradient and Jacobian are the central differences, and the value is the sum of squares."""
    value, gradient = aim.evaluate(point)
    jacobian = aim.jacobian(point)
    for k, step in enumerate(1e-6 * np.eye(len(point))):
        ahead, behind = aim.residuals(point + step), aim.residuals(point - step)
        assert np.allclose((ahead - behind) / 2e-6, jacobian[:, k], atol=1e-6)
        assert abs((ahead @ ahead - behind @ behind) / 2e-6 - gradient[k]) < 1e-5
    assert value == pytest.approx(float(aim.residuals(point) @ aim.residuals(point)))
