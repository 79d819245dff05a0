"""precise: computes tanh with an error of at most one unit of the last place."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from golden.activation.activation_block import ROM_WORDS, OddActivation
from golden.activation.precise_table import FORMATS, CurveFormat, CurveTable, curve_table
from golden.activation.scheme import Option, Scheme, require_exact
from golden.common.block import Block
from golden.numbers.fixed import Codes
from golden.numbers.precision import EXACT, SIGNAL, Precision
from golden.trained.dense import tanh

# The default of where the coefficients are stored.
COEFFICIENTS = "logic"
# Registers from the coefficients to the result: one behind the coefficients, one behind the rows,
# one before and one behind the multiplier, and one behind the sum.
STAGES = 5


@dataclass(frozen=True)
class Precise(OddActivation):
    """r = tanh(q), approximated by a parabola in each segment, on one multiplier.

    Let the magnitude m of q lie in segment s, let x be its distance from the middle of the segment,
    and let t be the top bits of its distance from the segment's start. Then r = floor(intercept + x
    (gradient - curve t)), with the sign of q.

    in_fmt, out_fmt: Formats of q and r: Fix(18,14) and Fix(14,13).
    coefficients: Where they are stored: "logic", 38 words in LUTs, or "block_ram", 299 words of 36
        bits in one block RAM, with narrower segments. ``precise_table.FORMATS`` holds the formats
        of both.
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
        """Formats of the coefficients, the slope and the sum."""
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
