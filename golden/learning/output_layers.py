"""Rules on the output layers alone: normalised LMS, Kaczmarz, and recursive least squares.

The weights and the bias of each output are learned, from the hidden words of its network:

    w += rate error h / (h . h)

The sources are those of ``golden.learning.gradient``. Recursive least squares on an output layer,
one placement at a time, is N.-Y. Liang, G.-B. Huang, P. Saratchandran and N. Sundararajan, "A fast
and accurate online sequential learning algorithm for feedforward networks", *IEEE Transactions on
Neural Networks* 17 (2006), 1411-1423 (OS-ELM). Here it is the square root of
``golden.learning.recursive``, which begins with the trained weights and an expected change of
``2**-SPREAD`` of each.

==========  ==========  ==================================================================
word        format      why
==========  ==========  ==================================================================
w           Fix(18,14)  as in the program; or 32 bits of which 28 are fraction, ``wide``
h, bias     Fix(18,17)  the bias has the word 1 - 2**-17
h . h       Fix(18,13)  at most the number of nodes and one
quotient    Fix(18,14)
==========  ==========  ==================================================================
"""

from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, RESULT, SAMPLE_SHIFT
from golden.fixed import Codes, Fix
from golden.learning.corrected import HALF, Corrected
from golden.learning.lesson import Lesson, start
from golden.learning.recursive import Recursive
from golden.learning.unit import WAIT, Unit, coefficient

WEIGHT = Fix(18, 14)
# The expected change of a weight is this power of one half.
SPREAD = 3


@dataclass(frozen=True)
class OutputLayers:
    """Normalised LMS on the output layers; Kaczmarz with ``halvings`` 0.

    halvings: The rate is ``2**-halvings``.
    wide: Whether a weight has 32 bits while it is learned.
    filters: Recursive least squares in the place of a rate; its noise is a quarter of r.
    """

    taught: Corrected
    halvings: int = 0
    wide: bool = False
    filters: Recursive | None = None

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> list[Codes]:
        """For each output its weights and, last, its bias, shape (drifts, nodes + 1)."""
        return [self._one(lesson, passes, output, unit) for output in range(self.taught.outputs)]

    def _one(self, lesson: Lesson, passes: int, output: int, unit: Unit) -> Codes:
        none = start(lesson, self.taught)
        first = trained(self.taught, output)
        kept = np.tile(first << (DROPPED if self.wide else 0), (lesson.drifts, 1))
        root = self.filters.begun(kept.shape, SPREAD) if self.filters else kept
        for _ in range(passes):
            for placement in range(len(lesson)):
                h = with_one(lesson.hidden(self.taught, none, placement, output, unit))
                weights = (kept + (1 << (DROPPED - 1))) >> DROPPED if self.wide else kept
                found = result(weights, h, unit)
                error = lesson.error(found, placement, output, unit)
                if self.filters:
                    # A row has two fraction bits more than h, so both sides are quarters.
                    kept, root = self.filters.updated(kept, root, h, error >> 2, output, unit)
                    continue
                squares = (h * coefficient(h)).sum(axis=1)
                length = unit.word("h . h", squares, h.shape[1], DROPPED + 4)
                moved = unit.quotient("quotient", error << (10 - self.halvings), length)
                unit.takes((2 + self.wide) * h.shape[1], WAIT)
                # A quotient has 14 fraction bits, a short h too.
                by = moved[:, np.newaxis] * coefficient(h)
                sums = (kept if self.wide else kept << DROPPED) + by
                if self.wide:
                    kept = unit.word("weight", sums, 0, 0, WEIGHT.width + DROPPED)
                else:
                    kept = unit.word("weight", sums, 0)
        return (kept + (1 << (DROPPED - 1))) >> DROPPED if self.wide else kept

    def process(self, learned: list[Codes], samples: Codes) -> Codes:
        """The output codes of frames of one drift each, shape (drifts, frames, outputs)."""
        found = []
        for drift, codes in enumerate(samples):
            unit = Unit(len(codes))
            words = codes << SAMPLE_SHIFT
            for output, weights in enumerate(learned):
                h = with_one(self.taught.hidden(output, words, unit))
                y = result(np.tile(weights[drift], (len(h), 1)), h, unit)
                words = np.hstack([words, y[:, np.newaxis]])
            found.append(words[:, self.taught.sensors :] >> OUTPUT_SHIFT)
        return np.array(found)


def trained(taught: Corrected, output: int) -> Codes:
    """The trained weights of an output and its bias, the weight of the largest word."""
    layer = taught.networks[output].layers[1]
    bias = layer.starts[0] - (HALF << DROPPED)
    unit = 1 << RESULT.frac
    return np.array([*layer.weights[0], (bias + unit // 2) // unit])


def with_one(hidden: Codes) -> Codes:
    """Hidden words with the word of the bias, which is the largest."""
    ones = np.full((len(hidden), 1), RESULT.high)
    return np.hstack([hidden, ones])


def result(weights: Codes, hidden: Codes, unit: Unit) -> Codes:
    """The words of an output, half a unit of it included, shape (drifts,)."""
    # A word of an output is rounded down, and the unit rounds to the nearest.
    half = (HALF << DROPPED) - (1 << (DROPPED - 1))
    sums = (weights * hidden).sum(axis=1)
    return unit.word("output", sums + half, hidden.shape[1])
