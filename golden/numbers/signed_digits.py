"""Whole numbers as signed digits, which are the cost of a product without a multiplier."""

import numpy as np

from golden.numbers.fixed import Codes
from golden.numbers.real import Real


def signed_digits(number: int) -> tuple[tuple[int, int], ...]:
    """The canonical signed digits of a number, from the lowest place upwards.

    Returns: ``number`` is the sum of ``sign << place``. No two digits are next to each other, and
        no other form has fewer digits (Reitwiesner 1960). 0 has no digits.
    """
    found = []
    place, rest = 0, number
    while rest:
        if rest & 1:
            # The digit is 1 or -1, whichever makes the next place 0.
            sign = 2 - (rest & 3)
            found.append((place, sign))
            rest -= sign
        rest >>= 1
        place += 1
    return tuple(found)


def digit_counts(numbers: Codes) -> Codes:
    """The number of canonical signed digits of each number in an array; each is below 2**60."""
    # Each bit in which a number and its triple differ stands for one digit.
    magnitudes = np.abs(numbers)
    counts: Codes = np.bitwise_count(magnitudes ^ 3 * magnitudes).astype(np.int64)
    return counts


def nearest_with(values: Real, most: int) -> Codes:
    """The whole numbers nearest to real values with at most 0, 1 and so on signed digits.

    They are the sum of the nearest power of two, the power nearest to the rest, and so on. No other
    number with so many digits is nearer.

    values, shape (values,): Magnitudes below 2**52.

    Returns: shape (most + 1, values).
    """
    found = np.zeros((most + 1, len(values)), dtype=np.int64)
    for count in range(1, most + 1):
        rest = values - found[count - 1]
        fraction, exponent = np.frexp(np.abs(rest))
        # A rest below one half is nearest to 0.
        power = np.where(
            np.abs(rest) < 0.5, 0, np.ldexp(1.0, np.maximum(exponent - (fraction < 0.75), 0))
        )
        found[count] = found[count - 1] + (np.sign(rest) * power).astype(np.int64)
    return found
