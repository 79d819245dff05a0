"""Placements whose outputs are known, and what one of them says about gains and offsets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE, SAMPLE_SHIFT
from golden.learning.corrected import GAIN_WEIGHT, HALF, OFFSET_WEIGHT, SLOPE, THETA, Corrected
from golden.learning.unit import SHORT, Unit, coefficient
from golden.numbers.fixed import Codes, Fix

# The format of an error, and of a derivative by theta, of which those of ``digit`` stay below 0.09.
ERROR = Fix(18, 17)
ROW = Fix(18, 19)
# That of a derivative by a corrected sample times the sample.
_TIMES_SAMPLE = Fix(18, SLOPE.frac + SAMPLE.frac - SHORT - DROPPED)


@dataclass(frozen=True)
class Lesson:
    """Placements in the order in which they are shown, for several drifts side by side.

    samples, shape (drifts, placements, sensors): Codes of what drifted sensors read.
    targets, shape (drifts, placements, outputs): Codes of the known outputs.
    """

    samples: Codes
    targets: Codes

    def __len__(self) -> int:
        return int(self.targets.shape[1])

    @property
    def drifts(self) -> int:
        return len(self.samples)

    def words(self, placement: int) -> Codes:
        """The words of the samples of a placement, shape (drifts, sensors)."""
        return np.asarray(self.samples[:, placement] << SAMPLE_SHIFT, dtype=np.int64)

    def known(self, placement: int) -> Codes:
        """The words of its known outputs, shape (drifts, outputs), as an engine keeps outputs."""
        return np.asarray((self.targets[:, placement] << OUTPUT_SHIFT) + HALF, dtype=np.int64)

    def hidden(
        self, taught: Corrected, theta: Codes, placement: int, output: int, unit: Unit
    ) -> Codes:
        """The hidden words of the network of an output, which reads known outputs before it."""
        corrected = taught.samples(theta, self.words(placement), unit)
        seen = np.hstack([corrected, self.known(placement)[:, :output]])
        return taught.hidden(output, seen, unit)

    def error(self, found: Codes, placement: int, output: int, unit: Unit) -> Codes:
        """The known output less the one found, shape (drifts,)."""
        known = self.known(placement)[:, output]
        return unit.word("error", (known - found) << DROPPED, 2)


@dataclass(frozen=True)
class Equation:
    """What an output of a placement says: ``error = row . (theta sought - theta)``.

    error: shape (drifts,).
    row, shape (drifts, 2 sensors): Derivatives of the output by theta.
    """

    error: Codes
    row: Codes


def equation(
    taught: Corrected, lesson: Lesson, theta: Codes, placement: int, output: int, unit: Unit
) -> Equation:
    """The equation of an output of a placement at ``theta``, through the network's derivatives.

    Equation: ``row = (dy/dz x G, dy/dz O)`` with the standard deviations G and O of theta.
    """
    hidden = lesson.hidden(taught, theta, placement, output, unit)
    found = taught.output(output, hidden, unit)[:, 0]
    error = lesson.error(found, placement, output, unit)
    return Equation(
        error, _row(taught, taught.slopes(output, hidden, unit), lesson.words(placement), unit)
    )


def row_weights(taught: Corrected) -> tuple[Codes, Codes]:
    """The weights of theta in a row: of a derivative times a sample, and of one alone."""
    gains = taught.gains << (ROW.frac + DROPPED - _TIMES_SAMPLE.frac - GAIN_WEIGHT)
    offsets = taught.offsets << (ROW.frac + DROPPED - SLOPE.frac - OFFSET_WEIGHT)
    return gains, offsets


def _row(taught: Corrected, slopes: Codes, samples: Codes, unit: Unit) -> Codes:
    """The derivatives by theta, of those by the corrected samples."""
    by_gain = unit.word("slope times sample", slopes * coefficient(samples), 1)
    gains, offsets = row_weights(taught)
    return np.hstack([unit.word("row", by_gain * gains, 1), unit.word("row", slopes * offsets, 1)])


def start(lesson: Lesson, taught: Corrected) -> Codes:
    """Theta without any correction, shape (drifts, 2 sensors)."""
    return np.zeros((lesson.drifts, 2 * taught.sensors), dtype=np.int64)


def bounded(theta: Codes, wanted: Codes, unit: Unit) -> Codes:
    """The new theta, or the old one where the step would leave its format, which is counted.

    theta, wanted: shape (drifts, 2 sensors).
    """
    inside = (wanted >= THETA.low) & (wanted <= THETA.high)
    fits = np.asarray(inside.all(axis=1), dtype=bool)
    unit.judge("step", fits)
    return np.where(fits[:, np.newaxis], wanted, theta)
