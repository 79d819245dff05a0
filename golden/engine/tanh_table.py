"""tanh for the engine: a straight line for every segment of q, computed in integers.

A segment is 2**w codes of q wide. Let i and s be the two words of the code's segment, the intercept
and the slope, and x the distance of the code from the middle of the segment. Then

        r = i + s x,    and for q below 0: r = s x - i

The segment of a negative q is that of its complement, -q - 1. x is taken from q itself in both
cases: the low bits of q with the highest of them inverted are x, as a signed number. So neither a
magnitude nor a negated result is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

from golden.engine.formats import HIDDEN, RESULT, WIDTH
from golden.input_error import InputError
from golden.numbers.fixed import Fix
from golden.numbers.transcendental import tanh_floors


@dataclass(frozen=True)
class LineTable:
    """The words of one or more blocks of segments, each from q = 0 upwards, or from -1 downwards.

    width: w, the number of bits of the distance within a segment.
    intercepts: The function in the middle of each segment, as codes of the block's format; in a
        block for negative q, those of minus the function.
    slopes: Codes of the same format.
    labels: For each block the name of its function, and the format of its results.
    """

    width: int
    intercepts: tuple[int, ...]
    slopes: tuple[int, ...]
    labels: tuple[tuple[str, Fix], ...] = (("tanh", RESULT),)

    @property
    def blocks(self) -> int:
        return len(self.labels)

    @property
    def segments(self) -> int:
        return len(self.slopes) // self.blocks

    def within(self, reach: int) -> LineTable:
        """The table without segments that no code of q reaches, whose largest magnitude is given.

        Where there are several blocks, each keeps a power of two of segments, and two at least.
        """
        count = min(self.segments, (reach >> self.width) + 1)
        if self.blocks > 1:
            count = max(2, 1 << (count - 1).bit_length())
        kept = [
            place
            for block in range(self.blocks)
            for place in range(block * self.segments, block * self.segments + count)
        ]
        return replace(
            self,
            intercepts=tuple(self.intercepts[place] for place in kept),
            slopes=tuple(self.slopes[place] for place in kept),
        )


# For each w, the bits of the distance within a segment, where the table ends. The word of the last
# segment also serves every q beyond, where its error is no larger than that of the lines before.
# With 6.5 or more, a line would reach 1 before the last segment, which is more than the last word,
# so the table would not be monotone.
ENDS = {7: Fraction(6), 8: Fraction(11, 2), 9: Fraction(5)}
_FRAC = 40


@lru_cache
def tanh_table(width: int) -> LineTable:
    """The words of every segment.

    width: 9, 8 or 7: 160 segments of 1/32, 352 of 1/64 or 768 of 1/128.

    The lines meet at the borders of the segments. There each line lies above tanh by half the
    amount by which a chord lies below it in the middle, so the error at the ends is as large as in
    the middle. The value at a border is an even code of the result, so that the mean of two, which
    is the intercept, is a code too.

    Every slope is odd. Therefore the product with a distance has its lowest set bit too far right
    for a sum half way between two results, and rounding treats q and -q alike: the function is odd.
    Making a slope odd moves a border by 2**-6 units of the result at most, which no rounding
    notices.
    """
    if width not in ENDS:
        raise InputError(f"segment_width: got {width}, expected one of {', '.join(map(str, ENDS))}")
    step = Fraction(1, 1 << (HIDDEN.frac - width))
    segments = int(ENDS[width] / step)
    curve = tanh_floors(step, segments, _FRAC)
    borders = [0]
    # A slope must stay below 1. The odd slope below 1 is the largest code.
    steepest = (1 << (WIDTH - 1)) >> (HIDDEN.frac - width)
    for value in curve[1:-1]:
        border = _even(int(value) + _overshoot(int(value), step))
        borders.append(min(border, borders[-1] + steepest))
    # The last segment is level, half way between tanh at its beginning and 1.
    level = min(_even((int(curve[-1]) + (1 << _FRAC)) // 2), RESULT.high - 1)
    borders += [level, level]
    pairs = list(pairwise(borders))
    rise = HIDDEN.frac - width
    return LineTable(
        width,
        tuple((low + high) // 2 for low, high in pairs),
        tuple(((high - low) << rise) - 1 for low, high in pairs),
    )


def _overshoot(value: int, step: Fraction) -> int:
    """How far a line is above tanh at its ends: h**2 |tanh''| / 16, tanh'' = -2 t (1 - t**2)."""
    one = 1 << _FRAC
    bend = value * (one * one - value * value) // (one * one)
    return int(bend * step * step / 8)


def _even(value: int) -> int:
    """The nearest even code of the result for a value with ``_FRAC`` fraction bits."""
    shift = _FRAC - RESULT.frac + 1
    return ((value + (1 << (shift - 1))) >> shift) << 1
