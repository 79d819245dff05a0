"""Conjugate gradients on placements that are kept.

All equations ``error = row . step`` of the kept placements are solved together, in the sense of
least squares, each divided by its noise r, with theta drawn towards 0 as in a regression with the
expected drift. The derivatives are computed again after each solution (Gauss and Newton). The
iterations are those for least squares of M. R. Hestenes and E. Stiefel, "Methods of conjugate
gradients for solving linear systems", *Journal of Research of the National Bureau of Standards* 49
(1952), 409-436. With rows A and errors b, both times ``least r / r``, and l = (least r)^2:

    s = A^T b - l theta,  p = s;   then, as often as there are unknowns,
    q = A p,  alpha = s.s / (q.q + l p.p),  step += alpha p,  b -= alpha q,
    s = A^T b - l (theta + step),  p = s + (s.s now / s.s before) p

=============  ==========================  ====================================================
word           format                      why
=============  ==========================  ====================================================
A              Fix(18,19)                  as a row
b, s, p, q     18 or 36 bits, below 1/4    s falls by orders of magnitude, with the residual
step           18 or 36 bits, below 8      as theta
alpha          10 bits after the point     from 1 to 1 / l
ratio          14 bits after the point     about 1
s.s, q.q, p.p  72 bits                     they fall by the square of that
=============  ==========================  ====================================================
"""

from dataclasses import dataclass

import numpy as np

from golden.engine.formats import WIDTH
from golden.fixed import Codes
from golden.learning.corrected import THETA, Corrected
from golden.learning.lesson import ROW, Lesson, bounded, equation, start
from golden.learning.recursive import SQUARE, root_of
from golden.learning.unit import Unit

# Fraction bits of the weight of an equation, of alpha, and of the ratio of two s.s.
_WEIGHT, _ALPHA, _RATIO = 17, 10, 14


@dataclass(frozen=True)
class Conjugate:
    """Conjugate gradients.

    noise, shape (drifts, outputs): r^2 of each output, with ``SQUARE`` fraction bits, above 0.
    width: Bits of the vectors, 18 or 36.
    """

    taught: Corrected
    noise: Codes
    width: int

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> Codes:
        """Theta after so many solutions, shape (drifts, 2 sensors)."""
        theta = start(lesson, self.taught)
        for _ in range(passes):
            rows, errors = self._system(lesson, theta, unit)
            step = self._solved(rows.astype(object), errors.astype(object), theta, unit)
            theta = bounded(theta, theta + step.astype(np.int64), unit)
        return theta

    def _system(self, lesson: Lesson, theta: Codes, unit: Unit) -> tuple[Codes, Codes]:
        """A with the shape (drifts, equations, unknowns), and b."""
        roots = root_of(self.noise)
        weights = (roots.min(axis=1, keepdims=True) << _WEIGHT) // roots
        weights = np.minimum(weights, (1 << _WEIGHT) - 1)
        rows, errors = [], []
        for placement in range(len(lesson)):
            for output in range(self.taught.outputs):
                found = equation(self.taught, lesson, theta, placement, output, unit)
                by = weights[:, output]
                rows.append(unit.word("A", found.row * by[:, np.newaxis], 1, _WEIGHT))
                # b has two fraction bits more than an error.
                errors.append(unit.word("b", found.error * by, 1, _WEIGHT - 2))
        return np.stack(rows, axis=1), np.stack(errors, axis=1)

    def _solved(self, rows: Codes, errors: Codes, theta: Codes, unit: Unit) -> Codes:
        """The step of theta, in integers of any size."""
        more, words = self.width - WIDTH, self.width // WIDTH
        _, equations, unknowns = rows.shape
        least = self.noise.min(axis=1)[:, np.newaxis].astype(object)
        residual = errors << more
        step = np.zeros_like(theta, dtype=object)

        def falling() -> Codes:
            """s, whose products have the fraction bits of a row more than the residual."""
            sums = (rows * residual[:, :, np.newaxis]).sum(axis=1)
            # theta: 14 bits and ``more``; least: 38; s: 19 and ``more``, and 19 are dropped.
            pull = least * ((theta.astype(object) << more) + step) >> (SQUARE + THETA.frac - 38)
            return unit.word("s", sums - pull, (equations + 1) * words, 19, self.width)

        s = falling()
        p = s
        before = (s * s).sum(axis=1)
        for _ in range(unknowns):
            sums = (rows * p[:, np.newaxis]).sum(axis=2)
            q = unit.word("q", sums, unknowns * words, ROW.frac, self.width)
            below = (q * q).sum(axis=1) + (least[:, 0] * (p * p).sum(axis=1) >> SQUARE)
            unit.takes((equations + 2 * unknowns) * words * words)
            unit.reaches(below)
            alpha = unit.quotient("alpha", before << _ALPHA, np.maximum(below, 1), self.width)
            by = alpha[:, np.newaxis]
            moved = step + unit.word("alpha p", by * p, words**2, _ALPHA + 5, self.width)
            step = unit.word("step", moved, words, 0, self.width)
            left = residual - unit.word("alpha q", by * q, words**2, _ALPHA, self.width)
            residual = unit.word("b", left, words, 0, self.width)
            s = falling()
            now = (s * s).sum(axis=1)
            ratio = unit.quotient("ratio", now << _RATIO, np.maximum(before, 1), self.width)
            p = unit.word(
                "p", (s << _RATIO) + ratio[:, np.newaxis] * p, words**2, _RATIO, self.width
            )
            before = now
        return unit.word("step", step, words, more)
