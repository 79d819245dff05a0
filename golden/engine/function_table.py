"""Tables for any functions of q, side by side in one memory: a straight line for each segment of q.

A segment is 2**w codes of q wide. Let i and s be the two words of the code's segment, the intercept
and the slope, and x the distance of the code from the middle of the segment. Then

        r = i + s x,    and for q below 0: r = s x - i

The segment of a negative q is that of its complement, -q - 1. x is taken from q itself in both
cases: the low bits of q with the highest of them inverted are x, as a signed number. So neither a
magnitude nor a negated result is needed.

A function takes one block of the memory or two. An odd function, such as tanh, has one. Any other
function has two: the first for q from 0 up, and the second for q from -1 down. The words of the
second hold minus the function in their intercepts, because the engine subtracts an intercept where
q is negative.

Blocks have 2**a words each, and lie one after the other from address 0 on, so the address of a
segment needs no adder:

        address = block 2**a + segment of q,   2**a: the segments of the whole range of q, or the
                                               least power of two that holds those it reaches

A step that looks up names ``2 * block + both`` in the field of its weight, where ``both`` is 1 for
two blocks. Then the first of them has an even number, and a negative q reads the next one, so the
lowest bit of the block's number is that of the name or ``both and q < 0``. No segment lies beyond a
block: where a table such as that of tanh ends earlier, its last word is repeated. An engine with
one block names none and adds nothing to the hardware of tanh.

The result is a word of 18 bits like any other. Its binary point is where the function's values and
slopes fit, and the next layer's weights allow for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Self

import numpy as np

from golden.engine.formats import DROPPED, HIDDEN, RESULT, WIDTH
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix
from golden.numbers.real import Real
from golden.numbers.transcendental import tanh_floors
from golden.trained.function import TANH, Function

# Bits of q within a segment, where hardware chooses none. The binary point of a function is always
# chosen with this width, so that it does not depend on what hardware chooses.
SEGMENT_WIDTH = 9
# For each w, the bits of the distance within a segment, where the table ends. The word of the last
# segment also serves every q beyond, where its error is no larger than that of the lines before.
# With 6.5 or more, a line would reach 1 before the last segment, which is more than the last word,
# so the table would not be monotone.
ENDS = {7: Fraction(6), 8: Fraction(11, 2), 9: Fraction(5)}
_FRAC = 40
# Functions other than tanh may have wider segments, so that many of them have room.
LEAST_WIDTH, MOST_WIDTH = min(ENDS), 13
# Steps of the search for the best slope, each of which leaves two thirds of an interval.
_STEPS = 30
# The places in a segment at which the search looks at a line, besides the segment's end.
_PLACES = 32
# Two processors may differ in the last bit of a function. With this, a code is rounded in the same
# way on both, also where the value lies half way between two codes.
_NUDGE = 2.0**-16
_MOST = RESULT.high
# Words that all tables of an engine may have together.
MOST_WORDS = 1 << 14


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
    labels: tuple[tuple[str, Fix], ...]

    @property
    def blocks(self) -> int:
        return len(self.labels)

    @property
    def segments(self) -> int:
        return len(self.slopes) // self.blocks

    def within(self, reach: int) -> Self:
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


@dataclass(frozen=True)
class FunctionTable:
    """The lines of one function.

    width: Bits of q within a segment.
    result: Format of the function's values.
    both: Whether there is a block for negative q.
    intercepts, slopes: The words of the block, or of both blocks.
    """

    function: Function
    width: int
    result: Fix
    both: bool
    intercepts: tuple[int, ...]
    slopes: tuple[int, ...]

    @cached_property
    def error(self) -> float:
        """The largest distance of a result from the function, over every code of q."""
        codes = np.arange(HIDDEN.low, HIDDEN.high + 1)
        found = self.result.to_real(self.results(codes))
        return float(np.abs(found - self.function.value(HIDDEN.to_real(codes))).max())

    def results(self, q: Codes) -> Codes:
        """The codes of the function that an engine computes for codes of q."""
        word = (self.sums(q) + (1 << (DROPPED - 1))) >> DROPPED
        return np.asarray(np.clip(word, RESULT.low, RESULT.high), dtype=np.int64)

    def sums(self, q: Codes) -> Codes:
        """The lines of the table at codes of q, in units of a product."""
        negative = q < 0
        per = len(self.slopes) // (1 + self.both)
        segment = np.minimum(np.where(negative, ~q, q) >> self.width, per - 1)
        segment += per * (negative & self.both)
        one = np.where(negative, -1, 1) << DROPPED
        distance = (q & ((1 << self.width) - 1)) - (1 << (self.width - 1))
        intercept, slope = (np.take(words, segment) for words in (self.intercepts, self.slopes))
        return np.asarray(intercept * one + slope * distance, dtype=np.int64)


@lru_cache
def is_odd(function: Function) -> bool:
    """Whether the function of -q is minus the function of q."""
    if function == TANH:
        return True
    q = HIDDEN.to_real(np.arange(HIDDEN.high + 1))
    right, left = function.value(q), function.value(-q)
    return bool(np.abs(right + left).max() <= 2.0**-40 * max(1.0, np.abs(right).max()))


@lru_cache
def table_of(function: Function, width: int) -> FunctionTable:
    """The table of a function, for segments of ``2**width`` codes.

    tanh has the table that is computed in integers.
    """
    if function == TANH:
        return FunctionTable(function, width, RESULT, False, *tanh_lines(width))
    if not LEAST_WIDTH <= width <= MOST_WIDTH:
        raise InputError(
            f"segment_width: got {width}, expected {LEAST_WIDTH} to {MOST_WIDTH} for functions "
            "other than tanh"
        )
    return _fitted(function, width, format_of(function))


@lru_cache
def tanh_lines(width: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Intercept and slope of tanh in every segment from q = 0 upwards, computed in integers.

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
    intercepts = tuple((low + high) // 2 for low, high in pairs)
    return intercepts, tuple(((high - low) << rise) - 1 for low, high in pairs)


def _overshoot(value: int, step: Fraction) -> int:
    """How far a line is above tanh at its ends: h**2 |tanh''| / 16, tanh'' = -2 t (1 - t**2)."""
    one = 1 << _FRAC
    bend = value * (one * one - value * value) // (one * one)
    return int(bend * step * step / 8)


def _even(value: int) -> int:
    """The nearest even code of the result for a value with ``_FRAC`` fraction bits."""
    shift = _FRAC - RESULT.frac + 1
    return ((value + (1 << (shift - 1))) >> shift) << 1


@lru_cache
def format_of(function: Function) -> Fix:
    """The format of a function's values: the one whose largest error is the least.

    The more fraction bits there are, the finer is a value, but the less steep is the steepest line.
    """
    if function == TANH:
        return RESULT
    if function.frac is not None:
        return Fix(WIDTH, function.frac)
    reach = np.abs(_values(function, both=True)).max()
    most = RESULT.frac
    while reach * 2.0**most > _MOST + 1:
        most -= 1
    if most < 0:
        raise InputError(
            f"function {function.name}: got values that reach {reach:g}, expected {_MOST} at most"
        )
    # With this one no slope is cut off, so that fewer fraction bits can only be worse.
    steepest = np.abs(_lines(function, SEGMENT_WIDTH)[0]).max() * 2.0**DROPPED
    least = most
    while least and steepest * 2.0**least > _MOST + 1:
        least -= 1
    tables = [
        _fitted(function, SEGMENT_WIDTH, Fix(WIDTH, frac)) for frac in range(most, least - 1, -1)
    ]
    return min(tables, key=lambda table: table.error).result


@lru_cache
def fits(function: Function, frac: int) -> bool:
    """Whether values with so many fraction bits hold a function, and words its slopes."""
    values = function.value(HIDDEN.to_real(np.arange(HIDDEN.low, HIDDEN.high + 1))) * 2.0**frac
    steepest = np.abs(np.diff(values)).max() * 2.0**DROPPED
    return bool(np.abs(values).max() <= _MOST and steepest <= _MOST)


def codes_of(functions: Sequence[Function]) -> dict[Function, int]:
    """For each function the code by which a step names its table; 0 where there is one block."""
    first, found = 0, dict[Function, int]()
    for function in _in_order(functions):
        odd = is_odd(function)
        found[function] = 2 * first + (not odd)
        first += 2 - odd
    return found


def blocks_of(functions: Sequence[Function]) -> int:
    """How many blocks some functions take."""
    return sum(2 - is_odd(function) for function in functions)


@lru_cache
def joined(functions: tuple[Function, ...], width: int) -> LineTable:
    """The blocks of some functions, one after the other; for tanh alone, its own table."""
    if functions == (TANH,):
        return LineTable(width, *tanh_lines(width), (("tanh", RESULT),))
    return in_blocks(functions, width)


@lru_cache
def in_blocks(functions: tuple[Function, ...], width: int, least: int = 0) -> LineTable:
    """The blocks of some functions, one after the other, and of zeros until there are ``least``."""
    tables = {function: table_of(function, width) for function in _in_order(functions)}
    labels = [
        (function.name, table.result)
        for function, table in tables.items()
        for _ in range(1 + table.both)
    ]
    unused = max(0, least - len(labels))
    segments = segments_of(width)
    words: list[tuple[int, int]] = []
    for table in tables.values():
        # The last line is repeated up to the end of the blocks.
        lines = list(zip(table.intercepts, table.slopes, strict=True))
        words += lines + lines[-1:] * (segments * (1 + table.both) - len(lines))
    intercepts, slopes = zip(*words, *[(0, 0)] * (unused * segments), strict=True)
    labels += [("unused", RESULT)] * unused
    return LineTable(width, intercepts, slopes, tuple(labels))


def segments_of(width: int) -> int:
    """The number of segments of the whole range of q, on one side of 0."""
    return 1 << (HIDDEN.width - 1 - width)


def check_words(table: LineTable) -> None:
    """Refuse tables that take too much memory."""
    words = len(table.slopes)
    if words > MOST_WORDS:
        raise InputError(
            f"functions: got {words} words, {table.segments} for each of {table.blocks} blocks, "
            f"expected {MOST_WORDS} at most; a larger hardware.segment_width, fewer functions or "
            "odd ones, which need one block and not two, take less"
        )


def _in_order(functions: Sequence[Function]) -> list[Function]:
    """Functions with two blocks first, so that the first of two has an even number."""
    return sorted(functions, key=is_odd)


def _values(function: Function, both: bool) -> Real:
    """The function at every code of q, from 0 up; and behind these, from -1 down."""
    codes = np.arange(HIDDEN.high + 1)
    return function.value(HIDDEN.to_real(np.concatenate([codes, ~codes]) if both else codes))


@lru_cache
def _lines(function: Function, width: int) -> tuple[Real, Real]:
    """The slope of the best line of each segment, and the values of each segment in rising order.

    The best line has the least largest error, at some places of the segment. This error is convex
    in the slope, so each step of the search compares two slopes and leaves out a third of the
    interval.
    """
    both = not is_odd(function)
    pieces = _values(function, both).reshape(-1, 1 << width)
    if both:
        half = len(pieces) // 2
        pieces = np.concatenate([pieces[:half], pieces[half:, ::-1]])
    span = 1 << width
    places = np.append(np.arange(0, span, span // _PLACES), span - 1)
    x, seen = _distances(width)[places], pieces[:, places]
    rises = np.diff(seen, axis=1) / np.diff(x)
    low, high = rises.min(axis=1), rises.max(axis=1)
    for _ in range(_STEPS):
        third = (high - low) / 3
        left, right = low + third, high - third
        first, second = (np.ptp(seen - s[:, np.newaxis] * x, axis=1) for s in (left, right))
        low, high = np.where(first > second, left, low), np.where(first > second, high, right)
    return (low + high) / 2, pieces


def _distances(width: int) -> Codes:
    span = 1 << width
    return np.arange(span) - span // 2


def _fitted(function: Function, width: int, result: Fix) -> FunctionTable:
    """The best lines of a function in codes of a format of its values."""
    steepness, pieces = _lines(function, width)
    unit = 2.0**result.frac
    slopes = np.clip(_rounded(steepness * unit * 2.0**DROPPED), -_MOST, _MOST)
    off = pieces * unit - slopes[:, np.newaxis] * _distances(width) * 2.0**-DROPPED
    middles = np.clip(_rounded((off.min(axis=1) + off.max(axis=1)) / 2), -_MOST, _MOST)
    both = not is_odd(function)
    if both:
        middles[len(middles) // 2 :] *= -1
    words = (tuple(part.astype(np.int64).tolist()) for part in (middles, slopes))
    return FunctionTable(function, width, result, both, *words)


def _rounded(values: Real) -> Real:
    found: Real = np.floor(values + (0.5 + _NUDGE))
    return found
