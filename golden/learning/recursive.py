"""Recursive least squares on gains and offsets: in covariance form, and as a square root.

This is the extended Kalman filter of S. Singhal and L. Wu, "Training multilayer perceptrons with
the extended Kalman algorithm", *Advances in Neural Information Processing Systems* 1 (1989),
133-140, for the 8 numbers of a correction in the place of all weights. Before any placement theta
is 0 with covariance P = I. An equation ``error = row . (theta sought - theta)`` with noise r gives

    covariance:   f = P row,  d^2 = row . f + r^2,  P -= (f / d) (f / d)^T
    square root:  v = S^T row,  f = S v,  d^2 = v . v + r^2,  S -= d / (d + r) (f / d) (v / d)^T

    theta += (f / d) (error / d)

The square root, P = S S^T, is J. E. Potter's; see P. G. Kaminski, A. E. Bryson and S. F. Schmidt,
"Discrete square root filtering: a survey of current techniques", *IEEE Transactions on Automatic
Control* 16 (1971), 727-736. The squares of a row of S add up to a variance, which only falls. So no
element of S leaves -1 to 1, whatever is read, and f / d, v / d and d / (d + r) are fractions too. P
has no such bound once it is rounded: it can cease to be positive, and then d^2 does too. A known
output enters neither P nor S. It enters error / d alone, the error in standard deviations of what
was expected, which ends at 8.

In a later pass the filter begins anew, with the derivatives at the theta that the pass before found
(Gauss and Newton): ``error + row . (theta there - theta)`` is in the place of the error.

===================  =================  ========================================================
word                 format             why
===================  =================  ========================================================
P, S, f / d          18 or 36 bits      fractions; 36 bits are two words, with a step for each
f                    two bits finer     below 1/4, as a row
v, d                 Fix(18,19)         a rounded v is the exact v of a row nearby
d^2                  35 fraction bits   the accumulator, which is not rounded
v / d, d / (d + r)   Fix(18,17)         fractions
error / d            Fix(18,14)         8 standard deviations either way
===================  =================  ========================================================
"""

from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED, RESULT, WIDTH
from golden.fixed import Codes, Fix
from golden.learning.corrected import THETA, Corrected
from golden.learning.lesson import ERROR, ROW, Lesson, bounded, equation, start
from golden.learning.unit import AROUND_QUOTIENT, SHORT, WAIT, Unit, coefficient

# Fraction bits of r^2 and of d^2, and of a fraction.
SQUARE = 2 * ROW.frac - SHORT
_FRACTION = RESULT.frac


@dataclass(frozen=True)
class Recursive:
    """Recursive least squares.

    noise, shape (drifts, outputs): r^2 of each output, with ``SQUARE`` fraction bits, above 0.
    width: Bits of P or S, 18 or 36.
    root: Whether the square root of P is kept.
    """

    taught: Corrected
    noise: Codes
    width: int
    root: bool

    @property
    def words(self) -> int:
        """Words of an element of P or S."""
        return self.width // WIDTH

    @property
    def more(self) -> int:
        """Bits of P or S beyond a word."""
        return self.width - WIDTH

    @property
    def one(self) -> int:
        """The largest element."""
        return Fix(self.width, 0).high

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> Codes:
        """Theta after so many passes over the placements, shape (drifts, 2 sensors)."""
        theta = start(lesson, self.taught)
        for number in range(passes):
            # The first pass takes the derivatives where it is; a later one where that one ended.
            there = theta
            theta = start(lesson, self.taught)
            kept = self.begun(theta.shape)
            for placement in range(len(lesson)):
                for output in range(self.taught.outputs):
                    at = there if number else theta
                    found = equation(self.taught, lesson, at, placement, output, unit)
                    missing = unit.word("distance", (at - theta) << DROPPED, 2)
                    # The short row has 16 fraction bits and theta 14, of the 31 of the error's sum.
                    more = (coefficient(found.row) * missing).sum(axis=1) << 1
                    sums = (found.error << DROPPED) + more
                    error = unit.word("error", sums, 1 + theta.shape[1])
                    theta, kept = self.updated(theta, kept, found.row, error, output, unit)
        return theta

    def begun(self, shape: tuple[int, ...], halvings: int = 0) -> Codes:
        """P or S before any placement, shape (drifts, unknowns, unknowns).

        shape: Drifts and unknowns.
        halvings: An unknown is expected to differ by ``2**-halvings``.
        """
        drifts, unknowns = shape
        found = np.zeros((drifts, unknowns, unknowns), dtype=np.int64)
        return np.asarray(found + (self.one >> halvings) * np.eye(unknowns, dtype=np.int64))

    def updated(
        self, theta: Codes, kept: Codes, row: Codes, error: Codes, output: int, unit: Unit
    ) -> tuple[Codes, Codes]:
        """Theta, and P or S, after one equation."""
        size, more, noise = row.shape[1], self.more, self.noise[:, output]
        if self.root:
            sums = _times(kept.transpose(0, 2, 1), coefficient(row))
            v = unit.word("v", sums, size * self.words, DROPPED + more)
            sums = _times(kept, coefficient(v))
            f = unit.word("f", sums, size * self.words, width=self.width)
            squares = (v * coefficient(v)).sum(axis=1) + noise
        else:
            sums = _times(kept, coefficient(row))
            f = unit.word("f", sums, size * self.words, width=self.width)
            v = f >> more
            squares = (row * coefficient(v)).sum(axis=1) + noise
        unit.takes(1 + size, WAIT)
        unit.reaches(squares)
        unit.judge("d^2", squares > 0)
        d = root_of(np.maximum(squares, 1) << SHORT)
        unit.takes(1, WIDTH + AROUND_QUOTIENT)
        below = d[:, np.newaxis]
        f_d = unit.quotient("f / d", f << _FRACTION, below, self.width)
        error_d = unit.quotient("error / d", error << (THETA.frac + ROW.frac - ERROR.frac), d)
        sums = (theta << DROPPED) + coefficient(f_d >> more) * error_d[:, np.newaxis]
        unit.takes(2 * size, WAIT)
        unit.reaches(sums)
        new = bounded(theta, (sums + (1 << (DROPPED - 1))) >> DROPPED, unit)
        if self.root:
            v_d = unit.quotient("v / d", v << _FRACTION, below)
            part = unit.quotient("d / (d + r)", d << _FRACTION, d + root_of(noise << SHORT))
            f_d = unit.word(
                "f / d", f_d * coefficient(part)[:, np.newaxis], self.words, width=self.width
            )
            falls = f_d[:, :, np.newaxis] * coefficient(v_d)[:, np.newaxis]
            terms = 2 * self.words
        else:
            falls = _squared(f_d, self.width)
            terms = 1 + self.words**2
        flat = ((kept << DROPPED) - falls).reshape(len(kept), -1)
        return new, unit.word("P or S", flat, terms, width=self.width).reshape(kept.shape)


def root_of(squares: Codes) -> Codes:
    """The whole part of a square root, exact, as subtraction bit by bit gives it."""
    found = np.floor(np.sqrt(squares.astype(np.float64))).astype(np.int64)
    found -= found * found > squares
    found += (found + 1) * (found + 1) <= squares
    return np.asarray(found, dtype=np.int64)


def _times(matrices: Codes, vectors: Codes) -> Codes:
    """Matrix times vector for each drift."""
    return np.asarray((matrices * vectors[:, np.newaxis]).sum(axis=2), dtype=np.int64)


def _squared(fractions: Codes, width: int) -> Codes:
    """The products of all pairs, with ``DROPPED`` fraction bits more, the same in either order."""
    if width == WIDTH:
        products = fractions[:, :, np.newaxis] * coefficient(fractions)[:, np.newaxis]
        upper = np.triu(products)
        return np.asarray(upper + np.triu(products, 1).transpose(0, 2, 1), dtype=np.int64)
    wide = fractions.astype(object)
    products = wide[:, :, np.newaxis] * wide[:, np.newaxis] >> (width - 1 - DROPPED)
    return np.asarray(products, dtype=np.int64)
