"""tanh and exp of evenly spaced arguments, rounded down, computed without binary floating point.

A floating-point library may round the last bit of a transcendental function in any way, and it does
so differently on different processors. Therefore the numbers that become hardware come from here.

The values exp(-x) on an even grid are powers of one ratio. The first value and the ratio come from
the decimal arithmetic of the standard library, all others from integers. With ``BITS`` fraction
bits, each value is the one before it times the ratio, rounded down. That is a lower bound. Adding k
gives an upper bound, where k grows by two with each step:

    w <= e < w + k, r <= ratio < r + 1, all at most 1, hence
    floor(w r) <= e ratio < floor(w r) + k + 2

A result is returned only if both bounds agree on it.
"""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import accumulate, repeat

import numpy as np

from golden.input_error import InputError
from golden.numbers.fixed import Codes

# After 2**17 steps the bounds are 2**-78 apart. The chance that they disagree on one of so many
# results with 29 fraction bits is 2**-31.
BITS = 96
_ONE = 1 << BITS


def tanh_floors(step: Fraction, points: int, frac: int) -> Codes:
    """The floors of tanh(n step) 2**frac, for n from 0 to ``points`` - 1.

    One fraction bit more than needed is enough for rounding to nearest: tanh of a fraction other
    than 0 is irrational, so an exact half cannot occur.

    step: Above 0 and at most 1/2.
    points: 2 or more.
    frac: 0 to 62.
    """
    # The result is (1 - e) / (1 + e) with e = exp(-2 q), which decreases when e grows.
    values, apart = _decays(2 * step, 2 * step, points - 1)
    less, more = _ONE - apart, _ONE + apart
    lower = [((less - e) << frac) // (more + e) for e in values]
    upper = [((_ONE - e) << frac) // (_ONE + e) for e in values]
    return _decided([0, *lower], [0, *upper])


def exp_floors(start: Fraction, step: Fraction, points: int, frac: int) -> Codes:
    """The floors of exp(-(start + n step)) 2**frac, for n from 0 to ``points`` - 1.

    As with ``tanh_floors``, one fraction bit more is enough for rounding to nearest.

    start, step: Above 0 and at most 1.
    points, frac: See ``tanh_floors``, also for the errors; one point is enough here.
    """
    values, apart = _decays(start, step, points)
    drop = BITS - frac
    return _decided([e >> drop for e in values], [(e + apart) >> drop for e in values])


def _decided(lower: list[int], upper: list[int]) -> Codes:
    """The results on which both bounds agree."""
    if lower != upper:
        n = next(n for n, pair in enumerate(zip(lower, upper, strict=True)) if len(set(pair)) > 1)
        raise ArithmeticError(f"result {n}: {BITS} fraction bits leave {lower[n]} or {upper[n]}")
    return np.array(lower, dtype=np.int64)


def _decays(start: Fraction, step: Fraction, points: int) -> tuple[Sequence[int], int]:
    """Lower bounds of exp(-(start + n step)) 2**BITS, and what to add for upper bounds."""
    if not (0 < start <= 1 and 0 < step <= 1 and points > 0):
        raise InputError(
            f"got {points} points from {start} in steps of {step}, expected one or more, above 0 "
            "and at most 1"
        )
    values = accumulate(
        repeat(_decay(step), points - 1),
        lambda value, ratio: (value * ratio) >> BITS,
        initial=_decay(start),
    )
    return list(values), 2 * points


def _decay(x: Fraction) -> int:
    """The floor of exp(-x) 2**BITS, for x above 0 and at most 1.

    The standard library defines each digit of these numbers; those behind BITS decide the floor.
    """
    with localcontext(prec=2 * BITS // 3):
        return int((Decimal(-x.numerator) / x.denominator).exp() * _ONE)
