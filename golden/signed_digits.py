"""Whole numbers as signed digits: what a product with a constant costs without a multiplier."""

from __future__ import annotations

from collections.abc import Iterable


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


def from_digits(digits: Iterable[tuple[int, int]]) -> int:
    """The number that signed digits stand for."""
    return sum(sign << place for place, sign in digits)
