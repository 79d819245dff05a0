"""The formats of the engine. They are the same for every scene, so the hardware is too."""

import numpy as np
from numpy.typing import ArrayLike

from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL

# The width of both inputs of one multiplier. The binary point of a weight follows from those of its
# operand and of the sum that it belongs to.
WIDTH = 18
PRODUCT_WIDTH = 2 * WIDTH
# A word of the operand memory, whose binary point depends on what it is.
WORD = Fix(WIDTH, 0)
# Bits of a word of a program.
WORD_WIDTH = 36
# A sample is shifted left in the operand memory, so that weights of layer 1 reach 32.
SAMPLE = Fix(WIDTH, 16)
SAMPLE_SHIFT = SAMPLE.frac - SIGNAL.frac
# The format of a hidden sum q, which is the input of tanh.
HIDDEN = EXACT.hidden_fmt
# The format of tanh and of an output in the operand memory. An output leaves the engine without its
# lowest bits.
RESULT = Fix(WIDTH, 17)
OUTPUT_SHIFT = RESULT.frac - SIGNAL.frac
# The number of fraction bits that are dropped when a sum becomes a word.
DROPPED = 14
# The format of the number one, which is the operand of a bias.
ONE = Fix(WIDTH, DROPPED)


def coeff_frac(result: Fix, operand: Fix) -> int:
    """Fraction bits of a weight between an operand and the word that its sum becomes."""
    return result.frac + DROPPED - operand.frac


def put(words: list[int], place: int, field: tuple[int, int], value: int) -> None:
    """Write a field of one of the words, where the field must hold 0 before."""
    low, bits = field
    words[place] |= (int(value) & ((1 << bits) - 1)) << low


def get(word: int, field: tuple[int, int]) -> int:
    """The bits of a field."""
    low, bits = field
    return (word >> low) & ((1 << bits) - 1)


def signed_code(bits: int) -> int:
    """Read bits of a word's width as a signed code."""
    return bits - ((bits >> (WIDTH - 1)) << WIDTH)


def word_of(sums: ArrayLike, relu: ArrayLike, cut: int = 0, even: bool = False) -> Codes:
    """The word of each sum, rounded, saturated, rectified and cut.

    Half a unit of the word, or of a quantiser, is contained in the sum.

    relu: Where a sum below 0 becomes 0.
    cut: Where there is ``relu``, so many of the lowest bits of the word become 0.
    even: Where bits are cut, a sum half way between two words becomes the even one.
    """
    totals = np.asarray(sums, dtype=np.int64)
    kept = totals >> DROPPED
    words = np.clip(kept, np.where(relu, 0, WORD.low), WORD.high)
    if cut:
        halfway = even & (totals & ((1 << (DROPPED + cut)) - 1) == 0) & (words == kept)
        words = np.where(relu, words & (-np.where(halfway, 2, 1) << cut), words)
    return np.asarray(words, dtype=np.int64)
