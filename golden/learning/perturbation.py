"""Perturbation without derivatives: simultaneous perturbation of all numbers, on kept placements.

J. C. Spall, "Multivariate stochastic approximation using a simultaneous perturbation gradient
approximation", *IEEE Transactions on Automatic Control* 37 (1992), 332-341. All numbers of theta
are moved at once by plus or minus c, at random; the loss is measured there and on the other side:

    theta -= a (loss(theta + c d) - loss(theta - c d)) / (2 c) d,   d: 1 or -1 for each number

The loss is the sum over placements and outputs of the squared errors, each divided by its r. The
program of the network stays as it is. The step a is halved in stages.

===============  ==========  ======================================================
word             format      why
===============  ==========  ======================================================
error / r        Fix(18,10)  the weight 1 / r is at most 1000, and what is beyond is cut
loss             32 bits     a sum of squares
step             Fix(18,14)  at most ``MOST`` at a time
===============  ==========  ======================================================
"""

from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED
from golden.fixed import Codes
from golden.learning.corrected import Corrected
from golden.learning.lesson import ERROR, Lesson, bounded, start
from golden.learning.unit import WAIT, Unit, coefficient

# c, in theta's format: 1/16 of a standard deviation.
DISTANCE = 1 << 10
# The largest step, an eighth of a standard deviation.
MOST = 1 << 11
# The fraction bits of an error divided by r, and of 1 / r as a weight.
ERROR_OVER_R = 10
OVER_R = ERROR_OVER_R + DROPPED - ERROR.frac
# How often the step is halved.
STAGES = 6


@dataclass(frozen=True)
class Perturbation:
    """Simultaneous perturbation.

    weights, shape (drifts, outputs): 1 / r of each output, with ``OVER_R`` fraction bits.
    shift: The first a: the difference of the losses is shifted so far to the right.
    seed: Of the random signs.
    """

    taught: Corrected
    weights: Codes
    shift: int
    seed: int = 1

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> Codes:
        """Theta after so many steps, each of two passes over the placements."""
        theta, rng = start(lesson, self.taught), np.random.default_rng(self.seed)
        for number in range(passes):
            signs = rng.integers(0, 2, theta.shape) * 2 - 1
            above, below = (
                unit.word("moved theta", (theta + way * DISTANCE * signs) << DROPPED, 2)
                for way in (1, -1)
            )
            apart = self._loss(lesson, above, unit) - self._loss(lesson, below, unit)
            kept = apart >> (self.shift + number * STAGES // passes)
            moved = np.clip(kept, -MOST, MOST)[:, np.newaxis] * signs
            unit.takes(2 * moved.shape[1], WAIT)
            theta = bounded(theta, theta - moved, unit)
        return theta

    def _loss(self, lesson: Lesson, theta: Codes, unit: Unit) -> Codes:
        """The sum of squares, shape (drifts,), of all placements together."""
        drifts, count = lesson.drifts, len(lesson)
        together = Lesson(
            lesson.samples.reshape(drifts * count, 1, -1),
            lesson.targets.reshape(drifts * count, 1, -1),
        )
        many, one = np.repeat(theta, count, axis=0), Unit(drifts * count)
        total = np.zeros(drifts * count, dtype=np.int64)
        for output in range(self.taught.outputs):
            hidden = together.hidden(self.taught, many, 0, output, one)
            found = self.taught.output(output, hidden, one)[:, 0]
            error = together.error(found, 0, output, one)
            by = np.repeat(self.weights[:, output], count)
            over = one.word("error / r", error * by, 1)
            total += over * coefficient(over)
            one.takes(1)
        unit.takes(one.steps * count, (one.clocks - one.steps) * count)
        for name, lost in one.saturated.items():
            unit.words[name] += one.words[name] * count
            unit.saturated[name] = unit.saturated.get(name, 0) + lost.reshape(drifts, -1).sum(
                axis=1
            )
        sums = total.reshape(drifts, count).sum(axis=1)
        return unit.word("loss", sums, 1, width=32)
