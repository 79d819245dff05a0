"""Steps along the derivatives, of constant length: LMS.

Each output of each placement is an equation ``error = row . (theta sought - theta)``. A step goes
part of the way to the nearest theta that satisfies it:

    theta += step error row - leak theta

This is LMS: B. Widrow and M. E. Hoff, "Adaptive switching circuits", *IRE WESCON Convention Record*
4 (1960), 96-104. Here the equations are those of the networks' derivatives, so every step is also a
step of back-propagation. The word of ``step error`` is Fix(18,12): the length of a step over that
of the row.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED
from golden.learning.corrected import THETA, Corrected
from golden.learning.lesson import ERROR, ROW, Equation, Lesson, bounded, equation, start
from golden.learning.unit import SHORT, WAIT, Unit, coefficient
from golden.numbers.fixed import Codes, Fix

_MOVED = Fix(18, THETA.frac + DROPPED - (ROW.frac - SHORT))
STEP = Fix(18, _MOVED.frac + DROPPED - ERROR.frac)
# About how many placements are kept, for the leak: with more of them it takes too much.
PLACEMENTS = 8
# A part of 2**-8, so that what all placements say is learned from a poor network too.
MOST_LEAK = 64


@dataclass(frozen=True)
class Gradient:
    """Steps along the derivatives.

    constant, shape (outputs, 2): Steps in the format ``STEP``, and leaks; see ``constants``.
    equation: What makes the equations.
    """

    taught: Corrected
    constant: Codes
    equation: Callable[..., Equation] = equation

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> Codes:
        """Theta after so many passes over the placements, shape (drifts, 2 sensors)."""
        theta = start(lesson, self.taught)
        for _ in range(passes):
            for placement in range(len(lesson)):
                for output in range(self.taught.outputs):
                    theta = self.step(lesson, theta, placement, output, unit)
        return theta

    def step(self, lesson: Lesson, theta: Codes, placement: int, output: int, unit: Unit) -> Codes:
        """Theta after the equation of one output of one placement."""
        found = self.equation(self.taught, lesson, theta, placement, output, unit)
        step, leak = self.constant[output]
        moved = unit.word("step times error", found.error * step, 1)
        # With 28 fraction bits.
        by = moved[:, np.newaxis] * coefficient(found.row)
        unit.takes(2 * by.shape[1], WAIT)
        wanted = (theta << DROPPED) + by - theta * leak
        unit.reaches(wanted)
        return bounded(theta, (wanted + (1 << (DROPPED - 1))) >> DROPPED, unit)


def constants(taught: Corrected, codes: Codes, targets: Codes) -> Codes:
    """The constant step and the leak of each output, shape (outputs, 2).

    The step is half of the largest with which no equation overshoots. The leak is what theta times
    ``2**-DROPPED`` loses in each step, so that what no placement tells goes back to no drift. Steps
    and leaks end at the most likely theta if ``leak = step r^2 / n``, where n is the number of
    placements, and r^2 the mean square of the network's own errors. Here n is ``PLACEMENTS``.

    codes, shape (rows, sensors): Samples of a recording.
    targets, shape (rows, outputs): Its known outputs.
    """
    rows = Lesson(codes[:, np.newaxis], targets[:, np.newaxis])
    unit, theta = Unit(rows.drifts), start(rows, taught)
    found = [equation(taught, rows, theta, 0, output, unit) for output in range(taught.outputs)]
    longest = np.array([(ROW.to_real(one.row) ** 2).sum(axis=1).max() for one in found])
    # An output that no sensor moves has the largest step there is.
    least = 0.5 / STEP.to_real(np.array(STEP.high))
    steps = STEP.quantise(0.5 / np.maximum(longest, least))[0]
    squares = np.array([(ERROR.to_real(one.error) ** 2).mean() for one in found])
    exact = STEP.to_real(steps) * squares / PLACEMENTS
    # Rounded so that their sum is the least above the exact one.
    leaks = np.diff(np.ceil(np.cumsum(exact) * (1 << DROPPED)), prepend=0).astype(np.int64)
    return np.stack([steps, np.minimum(leaks, MOST_LEAK)], axis=1)
