"""Equations 3.17 and 3.18 in floating point: a load as a continuous function along the beam."""

import math

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.domain import checked
from golden.numbers.real import Real

# Number of values in one chunk of the series, which is small enough for a cache and large enough
# for numpy.
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

    The thesis prints 1 / (n pi). There n is not defined, and only m gives its Figure 3.27.

    position: i_p, from 0 to 1 along the operating length. The arguments are broadcast.
    load, centre, half_width: d from -1 to 1, i_m from 0 to 1, and w from 0 to 1. The pulse reaches
        from i_m - w to i_m + w.
    terms: P, 1 or more.

    The sum has no constant term, so its mean over 0 to 1 is 0. It is therefore the pulse of height
    d minus the pulse's mean 2 d w: with the pulse inside 0 to 1, it is d (1 - 2 w) on the pulse and
    -2 d w beside it.

    Near a jump the sum overshoots by 0.0895 d, however many terms it has (Gibbs). The largest value
    is 1 / (P + 1) away from the jump. At the jump itself the sum is the mean of both sides.

    The time grows with the number of terms times the number of values; the memory does not grow
    with the number of terms. Phases are reduced to one turn before the sine is computed, so the
    rounding error stays below 1e-12 d for a million terms.
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
    """The four sawtooth arguments of equation 3.17, in units of pi, along a new first axis."""
    return np.stack([w + (p - c), w - (p - c), w + (p + c), w - (p + c)])


def harmonic_limit(
    position: ArrayLike, load: ArrayLike, centre: ArrayLike, half_width: ArrayLike
) -> Real:
    """The limit of equation 3.17 for an infinite number of terms, in closed form.

    A product of one sine and two cosines is a sum of four sines, and the sum over m of
    sin(m pi x) / (m pi) is the sawtooth (1 - x) / 2 for 0 < x < 2, 0 at x = 0, of period 2. So the
    limit is d times four sawtooths, at w + (i_p - i_m), w - (i_p - i_m), w + (i_p + i_m) and
    w - (i_p + i_m): the pulse, and its mirror images at both ends of the beam.
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
    """A bound of ``|harmonic_load - harmonic_limit|``, that is of the terms that are left out.

    By Abel's summation the terms beyond P of sum sin(m theta) / m stay below
    ``1 / ((P + 1) |sin(theta / 2)|)``, and partial sums and limit lie between 0 and
    the Wilbraham-Gibbs constant 1.852 on either side of 0, so the tail never exceeds that. At a
    jump (theta = 0) every term is 0, and so is the bound.
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

    The power is taken of the product, and not of C and of the distance separately as thesis section
    5.8 computes it, because C**P alone overflows for narrow loads. A power beyond the largest float
    becomes infinity, whose exponential is 0, which is right. So nothing overflows for any C and P.

    position, load, centre: i_p, d and i_m, all finite. The arguments are broadcast.
    steepness: C, above 0: f falls to d / e at the distance 1 / C from the centre.
    power: P, an even number: 2 for the pointed profile that stands for a triangle, 6 for the flat
        one that stands for a rectangle. With an odd power f would grow without bound on one side.
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
