"""Approximations of tanh that the thesis compares, in floating point (section 4.3.2).

The schemes that were built have their own functions: ``gradient_real`` (equation 4.3),
``polynomial_real`` (4.4), ``pade_real`` (4.10 to 4.12) and ``lut_real``. Here are the others, and
the regressions step by step. q is an array of any shape, and a result has the same shape.
"""

from math import sqrt

import numpy as np
from numpy.typing import ArrayLike

from golden.activation.pade import DENOMINATOR, fraction
from golden.input_error import InputError
from golden.numbers.real import Real


def taylor(q: ArrayLike) -> Real:
    """Equation 4.5: (e - 1) / (e + 1), with the series of e = exp(2 q) up to the fourth power."""
    x = 2 * np.asarray(q, dtype=np.float64)
    power = 1 + x * (1 + x / 2 * (1 + x / 3 * (1 + x / 4)))
    return np.asarray((power - 1) / (power + 1))


def pade_fraction(q: ArrayLike) -> Real:
    """q A(q) / B(q), equation 4.6."""
    real = np.asarray(q, dtype=np.float64)
    a, b = fraction(real)
    return real * a / b


def inverse_fraction(q: ArrayLike, iterations: int) -> Real:
    """B / A by equation 4.8: h <- B - h (A - 1), starting from 0.

    It settles where A(q) < 2, which is for ``|q|`` below 2.888.
    """
    real = np.asarray(q, dtype=np.float64)
    a, b = fraction(real)
    h = np.zeros_like(real)
    for _ in range(iterations):
        h = b - h * (a - 1)
    return h


def inverse(z: ArrayLike, iterations: int) -> Real:
    """1 / z by equation 4.9: v <- 1 - v (z - 1), starting from 0.

    It settles where 0 < z < 2. ``inverse_fraction`` gives q / tanh(q), so both together settle only
    for ``|q|`` below 1.915.
    """
    real = np.asarray(z, dtype=np.float64)
    v = np.zeros_like(real)
    for _ in range(iterations):
        v = 1 - v * (real - 1)
    return v


def rho_regression(q: ArrayLike, rho: float, iterations: int) -> Real:
    """The fraction by equations 4.10 to 4.12: d <- 1 / rho - d (B - rho) / rho from 0, times q A.

    It settles where B(q) < 2 rho; see ``stable_below``.
    """
    real = np.asarray(q, dtype=np.float64)
    a, b = fraction(real)
    d = np.zeros_like(real)
    for _ in range(iterations):
        d = 1 / rho - d * (b - rho) / rho
    return real * a * d


def stable_below(rho: float) -> float:
    """The ``|q|`` at which B(q) = 2 rho, from which on ``rho_regression`` diverges."""
    if rho <= 0.5:
        raise InputError(f"rho: got {rho}, expected above 0.5")
    c, d = DENOMINATOR
    return sqrt((sqrt(c * c + 4 * d * (2 * rho - 1)) - c) / (2 * d))
