"""Whole numbers as signed digits: what a product with a constant costs without a multiplier."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from golden.fixed import Codes

Real = NDArray[np.float64]


def signed_digits(number: int) -> tuple[tuple[int, int], ...]:
    """The canonical signed digits of a number, from the least place up.

    Returns
    -------
    tuple of (place, sign)
        ``number`` is the sum of ``sign << place``. No two digits stand side by side, and no other
        form has fewer (Reitwiesner 1960); 0 has none.
    """
    found = []
    place, rest = 0, number
    while rest:
        if rest & 1:
            # 1 or -1, whichever makes the next place 0.
            sign = 2 - (rest & 3)
            found.append((place, sign))
            rest -= sign
        rest >>= 1
        place += 1
    return tuple(found)


def digit_counts(numbers: Codes) -> Codes:
    """How many canonical signed digits each number of an array has; each below 2**60."""
    # A bit in which a number and its triple differ is a place of a digit.
    magnitudes = np.abs(numbers)
    counts: Codes = np.bitwise_count(magnitudes ^ 3 * magnitudes).astype(np.int64)
    return counts


def nearest_with(values: Real, most: int) -> Codes:
    """The whole numbers nearest to real values that have 0, 1 and so on signed digits at most.

    The power of two that is nearest, that nearest to the rest, and so on: no other number of so
    many digits is nearer.

    Parameters
    ----------
    values : float array, shape (values,)
        Magnitudes below 2**52.
    most : int

    Returns
    -------
    int64 array, shape (most + 1, values)
    """
    found = np.zeros((most + 1, len(values)), dtype=np.int64)
    for count in range(1, most + 1):
        rest = values - found[count - 1]
        fraction, exponent = np.frexp(np.abs(rest))
        # A rest below one half is nearest to none.
        power = np.where(
            np.abs(rest) < 0.5, 0, np.ldexp(1.0, np.maximum(exponent - (fraction < 0.75), 0))
        )
        found[count] = found[count - 1] + (np.sign(rest) * power).astype(np.int64)
    return found
