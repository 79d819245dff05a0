"""precise: computes tanh with an error of at most one unit of the last place.

A magnitude m, Fix(18,14), lies in segment s = m >> w; all segments have the same width 2**w. Let d
be the low w bits of m, x = d - 2**(w-1) the distance from the middle of the segment, and t the top
bits of d. Then

        slope = gradient - curve * t,    r = floor(intercept + x * slope)

is a parabola through the middle of the segment, and its second multiplication has only a few bits.
"""

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from golden.activation.activation_block import ROM_WORDS, OddActivation
from golden.activation.scheme import Option, Scheme, require_exact
from golden.common.block import Block
from golden.input_error import InputError
from golden.numbers.fixed import Codes, real_texts
from golden.numbers.precision import EXACT, SIGNAL, Precision
from golden.numbers.transcendental import tanh_floors
from golden.trained.dense import tanh

# How far from the least-squares fit the search goes, in units of the last place.
_NEAR_GRADIENT = 5
_NEAR_CURVE = 2

# From here on the nearest code to tanh is the largest one: tanh is 8191.26 units or more.
_SATURATED = 5

# Bits for the number of zeros at the end of an intercept.
_ZEROS_WIDTH = 6


@dataclass(frozen=True)
class CurveFormat:
    """Segments and formats of one variant of the table; every code is unsigned.

    segment_frac: A segment is 2**-segment_frac wide.
    top_width: Bits of t, the part of the distance by which the curve is multiplied.
    intercept_frac, gradient_frac, slope_frac: Fraction bits. The slope has at least as many as the
        gradient.
    curve_width: Bits of the curve, in units of the slope's last place.
    curved: Number of segments from q = 0 on that are fitted. Those above hold a constant, up to
        where the result stays 8191.
    """

    segment_frac: int
    top_width: int
    intercept_frac: int
    gradient_frac: int
    slope_frac: int
    curve_width: int
    curved: int

    @property
    def distance_width(self) -> int:
        """w, the number of bits of the distance from the start of a segment."""
        return EXACT.hidden_fmt.frac - self.segment_frac

    @property
    def gradient_shift(self) -> int:
        return self.slope_frac - self.gradient_frac

    @property
    def product_frac(self) -> int:
        return EXACT.hidden_fmt.frac + self.slope_frac

    @property
    def intercept_shift(self) -> int:
        return self.product_frac - self.intercept_frac

    @property
    def out_shift(self) -> int:
        return self.product_frac - SIGNAL.frac

    def split(self, mag: Codes) -> tuple[Codes, Codes, Codes]:
        """The segment, the distance x from its middle, and t, of each magnitude."""
        distance = mag & ((1 << self.distance_width) - 1)
        top = distance >> (self.distance_width - self.top_width)
        return (mag >> self.distance_width, distance - (1 << (self.distance_width - 1)), top)

    def slope(self, gradient: Codes, curve: Codes, top: Codes) -> Codes:
        """Compute gradient - curve * t with ``slope_frac`` fraction bits.

        The places below the gradient's last one are filled with ones. So the subtraction borrows
        nothing from the places above, and it is only as wide as the gradient.
        """
        filled = (gradient << self.gradient_shift) + (1 << self.gradient_shift) - 1
        return filled - curve * top


# 32 curved segments that are 1/8 wide, and constants from 4 on.
LOGIC = CurveFormat(3, 6, 16, 12, 14, 4, 32)
# Segments that are 1/64 wide. 512 words of 36 bits fill one block RAM.
BLOCK_RAM = CurveFormat(6, 3, 18, 13, 15, 5, 320)
FORMATS = {"logic": LOGIC, "block_ram": BLOCK_RAM}


@dataclass(frozen=True)
class CurveTable:
    """The coefficients of each segment; the last ones also serve every segment above."""

    intercepts: tuple[int, ...]
    gradients: tuple[int, ...]
    curves: tuple[int, ...]

    def meanings(self, fmt: CurveFormat) -> list[str]:
        """Intercept, gradient and curve of every segment as numbers."""
        columns = (
            real_texts(self.intercepts, fmt.intercept_frac),
            real_texts(self.gradients, fmt.gradient_frac),
            real_texts(self.curves, fmt.slope_frac),
        )
        return [", ".join(row) for row in zip(*columns, strict=True)]


@lru_cache
def curve_table(fmt: CurveFormat) -> CurveTable:
    """Choose the coefficients with the fewest wrongly rounded results.

    The candidates of a segment are those in a window around the least-squares parabola for which
    every result is within one unit of 2**-13 of tanh and none is below the one before it. Of these,
    the candidate that rounds the most codes correctly is chosen; among equals the intercept with
    the most zeros at its end, then the least curve, the least gradient, and the least intercept.
    All computation is in integers, so the table is the same on every machine. It takes about 0.1 s.
    """
    words: list[tuple[int, int, int]] = []
    last = 0
    step = Fraction(1, 1 << EXACT.hidden_fmt.frac)
    # The curve is in units of the exact sum, rounded down.
    curve = tanh_floors(step, int(_SATURATED / step), fmt.product_frac)
    for segment in range(len(curve) >> fmt.distance_width):
        word, results = _fit(fmt, segment, last, curve)
        words.append(word)
        last = int(results[-1])
        if results[0] == SIGNAL.high:
            break
    intercepts, gradients, curves = zip(*words, strict=True)
    return CurveTable(intercepts, gradients, curves)


def _fit(
    fmt: CurveFormat, segment: int, last: int, curve: Codes
) -> tuple[tuple[int, int, int], Codes]:
    """Coefficients of one segment, and its results; ``last`` is the result just before it."""
    width = fmt.distance_width
    mag = (segment << width) + np.arange(1 << width)
    _, x, top = fmt.split(mag)
    exact = curve[mag]
    half = 1 << (fmt.out_shift - 1)
    rounded = np.minimum((exact + half) >> fmt.out_shift, SIGNAL.high)
    # The results that are within one unit of tanh, which except at 0 is no whole number of units.
    # Zero has no sign, so its result must be zero for the function to be odd.
    lowest = exact >> fmt.out_shift
    highest = np.where(mag == 0, 0, np.minimum(lowest + 1, SIGNAL.high))
    gradients, curves = _candidates(fmt, segment, x, top, exact)
    linear = x * fmt.slope(gradients[:, np.newaxis], curves[:, np.newaxis], top)
    # One unit of the result, and the least intercept for which the sum reaches ``lowest``.
    unit = 1 << (fmt.intercept_frac - SIGNAL.frac)
    least = -((linear - (lowest << fmt.out_shift)) >> fmt.intercept_shift)
    # A code is rounded correctly by all intercepts of one unit, beginning with the first. Count,
    # for each candidate and intercept, how many codes it rounds correctly.
    first = least + unit * (rounded - lowest)
    base = int(first.min())
    span = int(first.max()) - base + unit + 1
    rows = np.arange(len(gradients))[:, np.newaxis] * span
    reached = np.bincount((rows + first - base).ravel(), minlength=len(gradients) * span)
    correct = np.cumsum(reached.reshape(-1, span), axis=1)
    correct[:, unit:] -= correct[:, :-unit].copy()
    intercept = base + np.arange(span)
    allowed = (
        (intercept > 0)
        & (intercept >= least.max(axis=1)[:, np.newaxis])
        & (intercept < (least + unit * (highest + 1 - lowest)).min(axis=1)[:, np.newaxis])
    )
    if segment >= fmt.curved:
        allowed &= intercept % unit == unit // 2
    # Among equals the intercept with the most zeros at its end is taken, since it needs the least
    # logic.
    zeros = np.bitwise_count((intercept & -intercept) - 1)
    candidates = np.flatnonzero(allowed)
    merit = ((correct << _ZEROS_WIDTH) + zeros).ravel()[candidates]
    for place in candidates[np.argsort(-merit, kind="stable")]:
        k, i = divmod(int(place), span)
        results = ((int(intercept[i]) << fmt.intercept_shift) + linear[k]) >> fmt.out_shift
        if results[0] >= last and (np.diff(results) >= 0).all():
            return (int(intercept[i]), int(gradients[k]), int(curves[k])), results
    raise InputError(f"segment {segment}: {fmt} is too coarse for one unit of 2**-13")


def _candidates(
    fmt: CurveFormat, segment: int, x: Codes, top: Codes, exact: Codes
) -> tuple[Codes, Codes]:
    """Gradients and curves around the least-squares fit to ``exact``, in units of the sum.

    The fit is linear in three columns: 1, the distance from the middle, and the product by which
    the curve is multiplied. The first two are orthogonal. So the part of the third that is
    independent of them gives the curve in closed form, as a quotient of whole numbers.
    """
    if segment >= fmt.curved:
        # A slope that consists only of the filled places moves no result by as much as a unit.
        return np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    points = len(x)
    # Twice the distance from the middle of the codes, which is half a code below the middle of the
    # segment. Its sum is 0.
    distance = 2 * x + 1
    bend = -x * top
    # Each of these sums is exact, since its terms are below 2**45 and there are 2**11 at most.
    spread, along, across = (int(distance @ c) for c in (distance, exact, bend))
    total, bent = int(exact.sum()), int(bend.sum())
    curve = _nearest(
        points * (spread * int(bend @ exact) - across * along) - spread * bent * total,
        points * (spread * int(bend @ bend) - across * across) - spread * bent * bent,
    )
    offset = ((1 << fmt.gradient_shift) - 1) * int(distance @ x)
    gradients, curves = [], []
    for near in range(curve - _NEAR_CURVE, curve + _NEAR_CURVE + 1):
        if 0 <= near < 1 << fmt.curve_width:
            straight = along - offset - near * across
            middle = _nearest(2 * straight, spread << fmt.gradient_shift)
            gradients.append(middle + np.arange(-_NEAR_GRADIENT, _NEAR_GRADIENT + 1))
            curves.append(np.full(2 * _NEAR_GRADIENT + 1, near))
    gradient, curvature = np.concatenate(gradients), np.concatenate(curves)
    # The slope is unsigned and is least where t is largest. The gradient is unsigned too, and below
    # 1.
    steepest = (1 << fmt.gradient_frac) - 1
    fitting = (fmt.slope(gradient, curvature, top.max(keepdims=True)) >= 0) & (gradient <= steepest)
    return gradient[fitting], curvature[fitting]


def _nearest(numerator: int, denominator: int) -> int:
    """The whole number nearest to a quotient; halves are rounded up."""
    return (2 * numerator + denominator) // (2 * denominator)


# The default of where the coefficients are stored.
COEFFICIENTS = "logic"
# Registers from the coefficients to the result: one behind the coefficients, one behind the rows,
# one before and one behind the multiplier, and one behind the sum.
STAGES = 5


@dataclass(frozen=True)
class Precise(OddActivation):
    """r = tanh(q), approximated by a parabola in each segment, on one multiplier.

    in_fmt, out_fmt: Formats of q and r: Fix(18,14) and Fix(14,13).
    coefficients: Where they are stored: "logic", 38 words in LUTs, or "block_ram", 299 words of 36
        bits in one block RAM, with narrower segments.
    words: Number of words that are kept, at least 1. They are those of the segments that the neuron
        can reach; in a scene the number is raised to a power of two, or to all words.

    Sum and product are exact; half a unit is part of the intercept. The function is odd and
    monotone. Over all 262144 codes every result is within one unit of 2**-13 of tanh(q)
    (tests/test_schemes.py). Of these results 12770 are not the nearest code with "logic", and 452
    with "block_ram". ``|-8|`` saturates.

    A magnitude beyond the words that are kept uses the last of them, and its result may wrap; the
    neuron cannot produce it.
    """

    block = "precise"
    coefficients: str
    words: int

    def __post_init__(self) -> None:
        known = f"one of {', '.join(FORMATS)}"
        self.require(self.coefficients in FORMATS, f"coefficients={self.coefficients!r}", known)
        self.check(words=(1, len(self.whole.intercepts)))

    @property
    def formats(self) -> CurveFormat:
        return FORMATS[self.coefficients]

    @property
    def whole(self) -> CurveTable:
        return curve_table(self.formats)

    @property
    def table(self) -> CurveTable:
        """The coefficients of the words kept."""
        whole, kept = self.whole, slice(self.words)
        return CurveTable(whole.intercepts[kept], whole.gradients[kept], whole.curves[kept])

    @property
    def memory_latency(self) -> int:
        """Clocks from an address to its coefficients; only a block RAM needs a clock."""
        return int(self.coefficients == "block_ram")

    @property
    def latency(self) -> int:
        return self.abs_unit.latency + self.memory_latency + STAGES + self.sign_retriever.latency

    def parts(self) -> tuple[Block, ...]:
        return self.abs_unit, self.sign_retriever

    def parts_left_out(self) -> Counter[str]:
        return +Counter({ROM_WORDS: len(self.whole.intercepts) - self.words})

    @property
    def marks(self) -> tuple[int, ...]:
        width = 1 << self.formats.distance_width
        return tuple(range(width - 1, self.abs_unit.fmt.high, width))[: self.words - 1]

    def compute(self, data: Codes) -> Codes:
        mag, negative = self.abs_unit.process(data)
        segment, x, top = self.formats.split(mag)
        word = np.minimum(segment, self.words - 1)
        table = self.table
        slope = self.formats.slope(np.take(table.gradients, word), np.take(table.curves, word), top)
        intercept = np.take(table.intercepts, word) << self.formats.intercept_shift
        result = (intercept + x * slope) >> self.formats.out_shift
        return self.sign_retriever.process(result & self.out_fmt.high, negative)


def precise_for(
    precision: Precision, factor: int, reach: int, coefficients: str = COEFFICIENTS
) -> Precise:
    """The precise activation for a neuron whose magnitudes go up to ``reach``."""
    require_exact("precise", precision, factor)
    fmt = FORMATS[coefficients]
    most = len(curve_table(fmt).intercepts)
    reached = min(reach, precision.hidden_fmt.high) // (1 << fmt.distance_width) + 1
    # The number is a power of two, so that neurons of similar reach share an entity.
    words = min(1 << (reached - 1).bit_length(), most)
    return Precise(
        precision.hidden_fmt, SIGNAL, coefficients, words, variant=f"{coefficients}{words}"
    )


SCHEME = Scheme(
    tanh, precise_for, {"coefficients": Option(COEFFICIENTS, tuple(FORMATS))}, precisions=(EXACT,)
)
