"""How a finished sum of an engine becomes a word: it is rounded, saturated, rectified and cut."""

import numpy as np
from numpy.typing import ArrayLike

from golden.engine.formats import DROPPED
from golden.engine.operand_memory import WORD
from golden.numbers.fixed import Codes


def word_of(sums: ArrayLike, relu: ArrayLike, cut: int = 0, even: bool = False) -> Codes:
    """The word of each sum, in which half a unit of the word, or of a quantiser, is contained.

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
