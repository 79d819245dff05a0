"""Equations 3.17 and 3.18 in floating point: a load as a continuous function along the beam."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from golden.domain import checked
from golden.input_error import InputError
from golden.real import Real

# Values of one chunk of the series: small enough for a cache, large enough for numpy.
CHUNK = 1 << 16

# The integral of sin(x) / x from 0 to pi.
WILBRAHAM_GIBBS = 1.8519370519824661


def _sum_domain(
    position: ArrayLike, load: ArrayLike, centre: ArrayLike, half_width: ArrayLike
) -> list[Real]:
    """The arguments of equation 3.17, checked and broadcast."""
    arrays = checked(
        position=(position, 0, 1),
        load=(load, -1, 1),
        centre=(centre, 0, 1),
        half_width=(half_width, 0, 1),
    )
    return list(np.broadcast_arrays(*arrays))


def harmonic_load(
    position: ArrayLike,
    load: ArrayLike,
    centre: ArrayLike,
    half_width: ArrayLike,
    terms: int,
) -> Real:
    """Equation 3.17: 4 d sum over m of sin(m w pi) cos(m i_m pi) cos(m i_p pi) / (m pi).

    The thesis prints 1 / (n pi); n is not defined, and only m gives its Figure 3.27.

    Parameters
    ----------
    position : array_like of float
        i_p, 0 to 1 along the operating length; the arguments broadcast.
    load, centre, half_width : array_like of float
        d, -1 to 1; i_m, 0 to 1; w, 0 to 1. The pulse reaches from i_m - w to i_m + w.
    terms : int
        P, 1 or more.

    Notes
    -----
    A sum without a constant term has the mean 0 over 0 to 1, so it is the pulse of height d less
    its own mean 2 d w: with the pulse inside 0 to 1, d (1 - 2 w) on it and -2 d w beside it.

    Near a jump the sum overshoots by 0.0895 d however many terms it has (Gibbs): the largest value
    stands 1 / (P + 1) from the jump. At the jump itself it is the middle of the two sides.

    Time grows with terms times values, memory does not grow with terms. Phases are reduced to one
    turn before the sine is taken; the rounding error stays below 1e-12 d for a million terms.

    Raises
    ------
    InputError
        For an argument outside its range, NaN included, or no terms.
    """
    if terms < 1:
        raise InputError(f"terms: got {terms}, expected 1 or more")
    p, d, c, w = _sum_domain(position, load, centre, half_width)
    total = np.zeros(p.shape)
    step = max(1, CHUNK // max(1, p.size))
    for first in range(1, terms + 1, step):
        m = np.arange(first, min(first + step, terms + 1), dtype=np.float64)
        m = m.reshape(-1, *[1] * p.ndim)
        sine = np.sin(np.pi * np.remainder(m * w, 2))
        cosines = np.cos(np.pi * np.remainder(m * c, 2)) * np.cos(np.pi * np.remainder(m * p, 2))
        total += (sine * cosines / (m * np.pi)).sum(axis=0)
    result: Real = 4 * d * total
    return result


def _phases(p: Real, c: Real, w: Real) -> Real:
    """The four sawtooth arguments of equation 3.17, in units of pi, on a new first axis."""
    return np.stack([w + (p - c), w - (p - c), w + (p + c), w - (p + c)])


def harmonic_limit(
    position: ArrayLike, load: ArrayLike, centre: ArrayLike, half_width: ArrayLike
) -> Real:
    """What equation 3.17 tends to for ever more terms, in closed form.

    A product of one sine and two cosines is a sum of four sines, and the sum over m of
    sin(m pi x) / (m pi) is the sawtooth (1 - x) / 2 for 0 < x < 2, 0 at x = 0, of period 2. So the
    limit is d times four sawtooths, at w + (i_p - i_m), w - (i_p - i_m), w + (i_p + i_m) and
    w - (i_p + i_m): the pulse, and its mirror images at both ends of the beam.

    Parameters
    ----------
    position, load, centre, half_width
        See ``harmonic_load``; the errors raised are its own.
    """
    p, d, c, w = _sum_domain(position, load, centre, half_width)
    x = np.remainder(_phases(p, c, w), 2)
    result: Real = d * np.where(x == 0, 0.0, (1 - x) / 2).sum(axis=0)
    return result


def harmonic_tail(
    position: ArrayLike,
    load: ArrayLike,
    centre: ArrayLike,
    half_width: ArrayLike,
    terms: int,
) -> Real:
    """A bound of ``|harmonic_load - harmonic_limit|``: what the terms left out can amount to.

    By Abel's summation the terms beyond P of sum sin(m theta) / m stay below
    ``1 / ((P + 1) |sin(theta / 2)|)``, and partial sums and limit lie between 0 and the
    Wilbraham-Gibbs constant 1.852 on either side of 0, so the tail never exceeds that. At a jump
    (theta = 0) every term is 0, and so is the bound.

    Parameters
    ----------
    position, load, centre, half_width, terms
        See ``harmonic_load``; the errors raised are its own.
    """
    if terms < 1:
        raise InputError(f"terms: got {terms}, expected 1 or more")
    p, d, c, w = _sum_domain(position, load, centre, half_width)
    x = np.remainder(_phases(p, c, w), 2)
    sine = np.sin(np.pi * x / 2)
    with np.errstate(divide="ignore", over="ignore"):
        tails = np.minimum(1 / ((terms + 1) * sine), WILBRAHAM_GIBBS)
    result: Real = np.abs(d) * np.where(x == 0, 0.0, tails).sum(axis=0) / np.pi
    return result


def power_load(
    position: ArrayLike,
    load: ArrayLike,
    centre: ArrayLike,
    steepness: ArrayLike,
    power: int,
) -> Real:
    """Equation 3.18: d exp(-(C (i_p - i_m))**P).

    The power is taken of the product, not of C and of the distance apart as thesis section 5.8
    computes it: C**P alone overflows for narrow loads. A power beyond the largest float is
    infinity, whose exponential is 0, the right value; nothing overflows for any C and P.

    Parameters
    ----------
    position, load, centre : array_like of float
        i_p, d and i_m, finite; the arguments broadcast.
    steepness : array_like of float
        C, above 0: f falls to d / e at the distance 1 / C from the centre.
    power : int
        P, even: 2 for the pointed profile that stands for a triangle, 6 for the flat one that
        stands for a rectangle. An odd power would grow without bound on one side.

    Raises
    ------
    InputError
        For an argument outside its range, NaN and infinity included.
    """
    if power < 2 or power % 2:
        raise InputError(f"power: got {power}, expected an even whole number, 2 or more")
    most, least = np.finfo(np.float64).max, math.ulp(0.0)
    p, d, c, s = checked(
        position=(position, -most, most),
        load=(load, -most, most),
        centre=(centre, -most, most),
        steepness=(steepness, least, most),
    )
    with np.errstate(over="ignore", under="ignore"):
        result: Real = d * np.exp(-((s * (p - c)) ** power))
    return result
