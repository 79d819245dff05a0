"""The arithmetic of an engine that learns: sums of products, which become words.

It is that of ``golden.engine.round_saturate``: a sum is exact, half a unit of its word is added,
the lowest bits are dropped, and what does not fit is saturated. Here every saturation is counted
under the name of its word, and so are the clocks.

A *product of two words* is not in an engine that does not learn. The program's weight, which is the
coefficient of the multiplier, is replaced by a second word of the memory without its ``SHORT``
lowest bits, with the sign kept. Of words with a and b fraction bits, the product has a + b -
``SHORT``, and its word has a + b - 17 after ``DROPPED`` bits: two fractions give a fraction. A
sample loses nothing, because its lowest bits are zeros.
"""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from golden.engine.formats import DROPPED, SAMPLE_SHIFT, WIDTH
from golden.engine.pipeline import Pipeline
from golden.numbers.fixed import Codes, Fix

# The lowest bits of a word that are dropped when it takes the place of a weight.
SHORT = SAMPLE_SHIFT
# Clocks from the last product of a sum to the first step that can read its word, less the one that
# the step takes itself. Sums that read nothing of each other share them.
WAIT = Pipeline().result_ready - 1


def coefficient(words: Codes) -> Codes:
    """Words in the place of weights."""
    return np.asarray(words >> SHORT, dtype=np.int64)


@dataclass
class Unit:
    """Counts what an engine does while it learns, on several drifts side by side.

    Arrays have one row for each drift. A call stands for words that read nothing of each other.

    steps, clocks: Steps and clocks of one drift. Each call waits for its words, so a scheduler can
        only be faster.
    words: How many words of each name one drift had.
    saturated, shape (drifts,): How many of them did not fit.
    bits: Bits of the largest sum, its sign included.
    """

    drifts: int
    steps: int = 0
    clocks: int = 0
    words: Counter[str] = field(default_factory=Counter)
    saturated: dict[str, Codes] = field(default_factory=dict)
    bits: int = 0

    def word(
        self, name: str, sums: Codes, terms: int, drop: int = DROPPED, width: int = WIDTH
    ) -> Codes:
        """The words of sums.

        name: What they are, for the count of saturations.
        sums: shape (drifts,) or (drifts, words).
        terms: Products in each sum.
        drop: Bits that are dropped.
        width: Bits of the words.
        """
        self.reaches(sums)
        kept = (sums + (1 << (drop - 1))) >> drop if drop else sums
        self.takes(terms * (sums.shape[1] if sums.ndim > 1 else 1), WAIT)
        return self._fitted(name, kept, width)

    def takes(self, steps: int, waits: int = 0) -> None:
        """Count steps, and clocks in which no step starts."""
        self.steps += steps
        self.clocks += steps + waits

    def reaches(self, sums: Codes) -> None:
        """Note the bits of sums before they are rounded."""
        self.bits = max(self.bits, int(np.abs(sums).max()).bit_length() + 1)

    def judge(self, name: str, fits: NDArray[np.bool_]) -> None:
        """Count words by whether they fit, shape (drifts,) or (drifts, words)."""
        rows = np.reshape(fits, (self.drifts, -1))
        self.words[name] += rows.shape[1]
        self.saturated[name] = self.saturated.get(name, 0) + (~rows).sum(axis=1)

    def _fitted(self, name: str, kept: Codes, width: int) -> Codes:
        ends = Fix(width, 0)
        fitted: Codes = np.clip(kept, ends.low, ends.high)
        self.judge(name, np.asarray(fitted == kept, dtype=bool))
        return fitted
