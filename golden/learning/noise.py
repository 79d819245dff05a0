"""How large the error of an equation is without any drift, from the recording of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from golden.fixed import Codes, Fix
from golden.learning.corrected import SLOPE, Corrected
from golden.learning.lesson import ERROR, Lesson, start
from golden.learning.unit import Unit
from golden.precision import SIGNAL
from golden.real import Real

if TYPE_CHECKING:
    from golden.scene import Vectors


@dataclass(frozen=True)
class Noise:
    """The errors of equations without any drift.

    own, shape (outputs,): Mean squares of the networks' own errors with known outputs before them.
    slopes, shape (outputs,): Mean squares of the length of the derivatives by the sensors.
    """

    own: Real
    slopes: Real

    @classmethod
    def of(cls, taught: Corrected, vectors: Vectors) -> Noise:
        """Those of a recording, bit-true."""
        targets = SIGNAL.quantise(vectors.targets)[0]
        rows = Lesson(vectors.codes[:, np.newaxis], targets[:, np.newaxis])
        unit, theta = Unit(rows.drifts), start(rows, taught)
        own, slopes = [], []
        for output in range(taught.outputs):
            hidden = rows.hidden(taught, theta, 0, output, unit)
            found = taught.output(output, hidden, unit)[:, 0]
            own.append(ERROR.to_real(rows.error(found, 0, output, unit)))
            slopes.append(SLOPE.to_real(taught.slopes(output, hidden, unit)))
        return cls(
            np.array([(error**2).mean() for error in own]),
            np.array([(slope**2).sum(axis=1).mean() for slope in slopes]),
        )

    def squares(self, readings: Real, fmt: Fix, factor: float = 1) -> Codes:
        """r^2 of each output as a constant of a program, at least one code.

        readings, shape (drifts,): Standard deviation of the noise of a reading as a signal.
        factor: What r^2 is multiplied by.

        Returns: shape (drifts, outputs).
        """
        squares = self.own + np.square(readings)[:, np.newaxis] * self.slopes
        return np.maximum(fmt.quantise(factor * squares)[0], 1)
