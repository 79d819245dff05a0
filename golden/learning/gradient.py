"""Steps along the derivatives: Kaczmarz and normalised LMS, and LMS with a constant step.

Each output of each placement is an equation ``error = row . (theta sought - theta)``. A step goes
part of the way to the nearest theta that satisfies it:

    theta += rate error row / (row . row + r^2)

With rate 1 and r = 0 this is S. Kaczmarz, "Angenaeherte Aufloesung von Systemen linearer
Gleichungen", *Bulletin International de l'Academie Polonaise des Sciences et des Lettres* A (1937),
355-357; with a smaller rate it is the normalised LMS of J. Nagumo and A. Noda, "A learning method
for system identification", *IEEE Transactions on Automatic Control* 12 (1967), 282-287. With a
constant in the place of the denominator it is LMS: B. Widrow and M. E. Hoff, "Adaptive switching
circuits", *IRE WESCON Convention Record* 4 (1960), 96-104. Here the equations are those of the
networks' derivatives, so every step is also a step of back-propagation.

=======================  ==========  ==========================================================
word                     format      why
=======================  ==========  ==========================================================
row . row                Fix(18,21)  below 0.01 for ``digit``
quotient, or its place   Fix(18,12)  the length of a step over that of the row
theta                    Fix(18,14)  or 32 bits of which 28 are fraction, ``wide``
=======================  ==========  ==========================================================
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED
from golden.fixed import Codes, Fix
from golden.learning.corrected import THETA, Corrected
from golden.learning.lesson import ERROR, ROW, Equation, Lesson, bounded, equation, start
from golden.learning.unit import SHORT, WAIT, Unit, coefficient

# The format of ``row . row``, of a quotient, and of a constant step.
LENGTH = Fix(18, 2 * ROW.frac - SHORT - DROPPED)
QUOTIENT = Fix(18, THETA.frac + DROPPED - (ROW.frac - SHORT))
STEP = Fix(18, QUOTIENT.frac + DROPPED - ERROR.frac)
# How far an error is shifted to the left before it is divided, with a rate of 1.
QUOTIENT_SHIFT = LENGTH.frac + QUOTIENT.frac - ERROR.frac
# About how many placements are kept, for the leak: with more of them it takes too much.
PLACEMENTS = 8
# A part of 2**-8, so that what all placements say is learned from a poor network too.
MOST_LEAK = 64


@dataclass(frozen=True)
class Gradient:
    """Steps along the derivatives.

    halvings: The rate is ``2**-halvings``.
    noise, shape (drifts, outputs): r^2 of each output, in the format ``LENGTH``.
    constant, shape (outputs, 2): Constant steps in the format ``STEP``, which contain the rate, and
        leaks; see ``constants``. None to divide.
    wide: Whether theta has 32 bits.
    equation: What makes the equations: ``equation`` or ``by_differences``.
    """

    taught: Corrected
    halvings: int
    noise: Codes
    constant: Codes | None = None
    wide: bool = False
    equation: Callable[..., Equation] = equation

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> Codes:
        """Theta after so many passes over the placements, shape (drifts, 2 sensors)."""
        kept = start(lesson, self.taught)
        for _ in range(passes):
            for placement in range(len(lesson)):
                for output in range(self.taught.outputs):
                    kept = self.step(lesson, kept, placement, output, unit)
        return self.theta(kept)

    def theta(self, kept: Codes) -> Codes:
        """The words of theta of what is kept."""
        return (kept + (1 << (DROPPED - 1))) >> DROPPED if self.wide else kept

    def step(self, lesson: Lesson, kept: Codes, placement: int, output: int, unit: Unit) -> Codes:
        """What is kept after the equation of one output of one placement."""
        theta = self.theta(kept)
        found = self.equation(self.taught, lesson, theta, placement, output, unit)
        if self.constant is None:
            squares = (found.row * coefficient(found.row)).sum(axis=1)
            length = unit.word(
                "row . row", squares + (self.noise[:, output] << DROPPED), found.row.shape[1] + 1
            )
            length = np.maximum(length, 1)
            shifted = found.error << (QUOTIENT_SHIFT - self.halvings)
            moved = unit.quotient("quotient", shifted, length)
        else:
            moved = unit.word("quotient", found.error * self.constant[output, 0], 1)
        # With 28 fraction bits.
        by = moved[:, np.newaxis] * coefficient(found.row)
        unit.takes((2 + self.wide) * by.shape[1], WAIT)
        wanted = (kept if self.wide else kept << DROPPED) + by
        if self.constant is not None:
            wanted = wanted - theta * self.constant[output, 1]
        unit.reaches(wanted)
        words = (wanted + (1 << (DROPPED - 1))) >> DROPPED
        new = bounded(theta, words, unit)
        if not self.wide:
            return new
        return np.where((new == words).all(axis=1)[:, np.newaxis], wanted, kept)


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
