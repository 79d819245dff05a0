"""The table tanh_rounding: what a table of lines needs to round every tanh correctly."""

from fractions import Fraction

import numpy as np

from golden.engine.formats import DROPPED, HIDDEN, RESULT, WIDTH
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.transcendental import tanh_floors
from tactus.report.measure.table import Cell, Table

WIDTHS = (9, 8, 7, 6, 5, 4)
# The longest segments, which are halved where they have no line. Of these, only the level one at
# the end has one.
LONGEST = 13
# The number of fraction bits of the reference.
FRAC = 40
# Words of a result in a unit of the outputs.
WORDS = 1 << (RESULT.frac - SIGNAL.frac)
# Codes of a slope in an output's unit for each code of q.
SLOPES = WORDS << DROPPED


def tanh_rounding(_: int) -> Table:
    """Every width of a segment, segments that are halved, and segments of any length."""
    codes = rounded()
    rows: list[list[Cell]] = []
    for width in WIDTHS:
        segments = cut(codes, width)
        count, lines, words = len(segments), len(with_line(segments)), len(with_words(segments))
        rows.append([f"{1 << width} codes", count, count - lines, count - words])
    rows.append(["halved where there is no line", halved(codes), 0, 0])
    rows.append(["as long as a line allows", fewest(codes), 0, "-"])
    return Table(
        "tanh_rounding",
        ["segments", "words", "without a line", "without an engine's line"],
        rows,
        "Is there a table of lines that gives tanh, rounded correctly to 13 fraction bits, for "
        "every q? The table counts the segments of q from 0 to the first level one, those for "
        "which there is no straight line at all, and those for which there is none with an "
        "intercept and a slope of 18 bits, as an engine has them. In the row before the last, "
        "segments of 8192 codes are halved until there is such a line. In the last row every "
        "segment has the length that any line allows, so no table of lines has fewer words.",
    )


def rounded() -> Codes:
    """tanh of every q from 0 upwards, rounded correctly to the fraction bits of an output."""
    floors = tanh_floors(Fraction(1, 1 << HIDDEN.frac), HIDDEN.high + 1, FRAC)
    unit = 1 << (FRAC - SIGNAL.frac)
    return np.array([min((value + unit // 2) // unit, SIGNAL.high) for value in floors.tolist()])


def cut(codes: Codes, width: int) -> Codes:
    """Segments of 2**width codes; the first that is level at the end serves every q behind it."""
    segments = codes.reshape(-1, 1 << width)
    return segments[: int(np.argmax(segments[:, 0] == codes[-1])) + 1]


def slopes(segments: Codes) -> tuple[Real, Real]:
    """For each segment, the limits between which the slope of a line must lie.

    A line that rounds to a and b at a distance of d climbs by more than b - a - 1 and by less than
    b - a + 1 between them. A slope for which this is so for every pair is that of a line. So there
    is no line where the first limit is not below the second. Two quotients of numbers as small as
    these are equal in floating point only if they are equal, so the comparison is exact.
    """
    below, above = np.full(len(segments), -1.0), np.full(len(segments), 2.0)
    for gap in range(1, segments.shape[1]):
        rise = segments[:, gap:] - segments[:, :-gap]
        below = np.maximum(below, (rise.max(axis=1) - 1) / gap)
        above = np.minimum(above, (rise.min(axis=1) + 1) / gap)
    return below, above


def with_line(segments: Codes) -> Codes:
    """The numbers of the segments for which a line with any real numbers gives every code."""
    below, above = slopes(segments)
    return np.flatnonzero(below < above)


def with_words(segments: Codes) -> Codes:
    """The numbers of the segments for which an engine has an intercept and a slope."""
    below, above = slopes(segments)
    found = [n for n in np.flatnonzero(below < above) if _words(segments[n], below[n], above[n])]
    return np.array(found, dtype=np.int64)


def _words(segment: Codes, below: float, above: float) -> bool:
    """Whether an engine's line gives every code, with a slope between two limits.

    The sum s of intercept and slope gives the word r = (s + half a word) >> DROPPED, and this the
    code (r + WORDS / 2) // WORDS. Slopes are odd, so a negative q has the negative result.
    """
    half = len(segment) // 2
    distance = np.arange(-half, half)
    least = ((WORDS * segment - WORDS // 2) << DROPPED) - (1 << (DROPPED - 1))
    last = min(int(above * SLOPES), (1 << (WIDTH - 1)) - 1)
    possible = np.arange(int(below * SLOPES) | 1, last + 1, 2)
    # Those in the middle leave most room for an intercept, so all the others are seldom tried.
    middle = len(possible) // 2
    for tried in (possible[max(0, middle - 8) : middle + 8], possible):
        ends = least - tried[:, np.newaxis] * distance
        # The intercept is a whole word, and no sum reaches the end of its code.
        intercepts = -(-ends.max(axis=1) >> DROPPED) << DROPPED
        if np.any(intercepts < ends.min(axis=1) + (WORDS << DROPPED)):
            return True
    return False


def halved(codes: Codes) -> int:
    """How many segments there are if those without an engine's line are halved."""
    count, segments = 0, cut(codes, LONGEST)
    while len(segments):
        good = with_words(segments)
        count += len(good)
        # One code alone always has a line.
        half = max(1, segments.shape[1] // 2)
        segments = np.delete(segments, good, axis=0).reshape(-1, half)
    return count


def fewest(codes: Codes) -> int:
    """The fewest segments, each with a line of its own.

    Every part of a segment has a line if the whole has one. So it is best to make each segment as
    long as it can be, one after the other.
    """
    count, start, level = 0, 0, int(np.argmax(codes == codes[-1]))
    while start < level:
        end, below, above = start + 1, -1.0, 2.0
        while end < len(codes) and below < above:
            rise, gap = codes[end] - codes[start:end], np.arange(end - start, 0, -1)
            below = max(below, float(((rise - 1) / gap).max()))
            above = min(above, float(((rise + 1) / gap).min()))
            end += 1
        count, start = count + 1, end - (below >= above)
    return count
