"""tanh for the engine: a straight line for every segment of q, found over integers.

A segment is 2**w codes of q wide. With i and s the two words of its segment, and x the distance of
the code from the middle of the segment,

    r = i + s x,    for q below 0: r = s x - i

The segment of a negative q is that of its complement, -q - 1, and x is taken from q itself in both
cases: the low bits of q, their highest one inverted, are a signed number. So neither a magnitude
nor a negated result is needed.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

from golden.engine.formats import HIDDEN, RESULT, WIDTH
from golden.input_error import InputError
from golden.transcendental import tanh_floors

# By w, bits of the distance within a segment: where the table ends. The word of the last segment
# holds for every q beyond, and there errs no more than the lines do before.
ENDS = {7: Fraction(6), 8: Fraction(11, 2), 9: Fraction(5)}
_FRAC = 40


@dataclass(frozen=True)
class TanhTable:
    """Words by segment, from q = 0 on.

    Parameters
    ----------
    width : int
        w, bits of the distance within a segment.
    intercepts : tuple of int
        tanh in the middle of each segment, Fix(18,17).
    slopes : tuple of int
        Fix(18,17).
    """

    width: int
    intercepts: tuple[int, ...]
    slopes: tuple[int, ...]


@lru_cache
def tanh_table(width: int) -> TanhTable:
    """The words of every segment.

    Parameters
    ----------
    width : int
        9, 8 or 7: 160 segments of 1/32, 352 of 1/64 or 768 of 1/128.

    Raises
    ------
    InputError
        For another width.
    """
    if width not in ENDS:
        raise InputError(f"segment_width: got {width}, expected one of {', '.join(map(str, ENDS))}")
    return fitted(width, ENDS[width])


def fitted(width: int, end: Fraction) -> TanhTable:
    """The words of the segments up to an end.

    Parameters
    ----------
    width : int
        See ``TanhTable``.
    end : Fraction
        A multiple of a segment, 6 at most: from 6.5 on a line reaches 1 before it, which is above
        the last word, and the table is not monotone.

    Notes
    -----
    The lines meet on the borders of the segments, where each is above tanh by half of what a chord
    is below it in the middle: then the error is as large at the ends as in the middle. The value
    on a border is an even code of the result, so that its middle, the intercept, is a code too.
    Every slope is odd. The product with a distance then has its lowest one too far to the right for
    a sum that lies half way between two results, and rounding treats q and -q alike: the function
    is odd. The odd slope moves a border by 2**-6 units of the result at most, which no rounding
    sees.
    """
    step = Fraction(1, 1 << (HIDDEN.frac - width))
    segments = int(end / step)
    curve = tanh_floors(step, segments, _FRAC)
    borders = [0]
    # A slope must stay below 1; the odd one below is the largest code.
    steepest = (1 << (WIDTH - 1)) >> (HIDDEN.frac - width)
    for value in curve[1:-1]:
        border = _even(int(value) + _overshoot(int(value), step))
        borders.append(min(border, borders[-1] + steepest))
    # Level, half way between tanh at its beginning and 1.
    level = min(_even((int(curve[-1]) + (1 << _FRAC)) // 2), RESULT.high - 1)
    borders += [level, level]
    pairs = list(pairwise(borders))
    rise = HIDDEN.frac - width
    return TanhTable(
        width,
        tuple((low + high) // 2 for low, high in pairs),
        tuple(((high - low) << rise) - 1 for low, high in pairs),
    )


def _overshoot(value: int, step: Fraction) -> int:
    """What a line is above tanh at its ends: h**2 |tanh''| / 16, with tanh'' = -2 t (1 - t**2)."""
    one = 1 << _FRAC
    bend = value * (one * one - value * value) // (one * one)
    return int(bend * step * step / 8)


def _even(value: int) -> int:
    """The even code of the result that is nearest, of ``_FRAC`` fraction bits."""
    shift = _FRAC - RESULT.frac + 1
    return ((value + (1 << (shift - 1))) >> shift) << 1
