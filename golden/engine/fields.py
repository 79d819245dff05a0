"""The fields of a program's word, and the word that a finished sum becomes.

A field is a pair: its lowest bit and its number of bits.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from golden.engine.formats import DROPPED, WIDTH, WORD
from golden.numbers.fixed import Codes

Bits = TypeVar("Bits", int, Codes)
# The fields of a word of an engine that learns. A word of the table holds a slope and an
# intercept. Where there are several blocks of the table, the weight of a step that looks up names
# the block; see golden/engine/function_table.py.
WEIGHT = (0, WIDTH)
SOURCE = (18, 10)
KIND = (28, 2)
TAKE_INTERCEPT = (30, 1)
FIRST = (31, 1)
FIRST_OF_OUTPUT = (32, 1)
STORE = (33, 1)
OUTPUT = (34, 1)
END = (35, 1)
INTERCEPT = (WIDTH, WIDTH)
SLOPE = (0, WIDTH)


def put(words: list[int], place: int, field: tuple[int, int], value: int) -> None:
    """Write a field of one of the words, where the field must hold 0 before."""
    low, bits = field
    words[place] |= (int(value) & ((1 << bits) - 1)) << low


def get(word: int, field: tuple[int, int]) -> int:
    """The bits of a field."""
    low, bits = field
    return (word >> low) & ((1 << bits) - 1)


def signed_code(bits: Bits) -> Bits:
    """Read bits of a word's width as a signed code; from an array, each element."""
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
