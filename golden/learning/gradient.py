"""Steps along the derivatives, of constant length: LMS.

Each output of each placement is an equation ``error = row . (theta sought - theta)``. A step goes
part of the way to the nearest theta that satisfies it:

    theta += step error row - leak theta

This is LMS: B. Widrow and M. E. Hoff, "Adaptive switching circuits", *IRE WESCON Convention Record*
4 (1960), 96-104. Here the equations are those of the networks' derivatives, so every step is also a
step of back-propagation. The word of ``step error`` is Fix(18,12): the length of a step over that
of the row.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE, SAMPLE_SHIFT
from golden.learning.corrected import (
    GAIN_WEIGHT,
    HALF,
    HALF_WORD,
    OFFSET_WEIGHT,
    SHORT,
    SLOPE,
    THETA,
    Corrected,
    rounded,
)
from golden.numbers.fixed import Codes, Fix

# The format of an error, and of a derivative by theta, of which those of ``digit`` stay below 0.09.
ERROR = Fix(18, 17)
ROW = Fix(18, 19)
# That of a derivative by a corrected sample times the sample.
_TIMES_SAMPLE = Fix(18, SLOPE.frac + SAMPLE.frac - SHORT - DROPPED)
_MOVED = Fix(18, THETA.frac + DROPPED - (ROW.frac - SHORT))
STEP = Fix(18, _MOVED.frac + DROPPED - ERROR.frac)
# About how many placements are kept, for the leak: with more of them it takes too much.
PLACEMENTS = 8
# A part of 2**-8, so that what all placements say is learned from a poor network too.
MOST_LEAK = 64


def known_words(known: Codes) -> Codes:
    """The words of codes of known outputs, as an engine keeps outputs."""
    return np.asarray((known << OUTPUT_SHIFT) + HALF, dtype=np.int64)


def hidden_words(
    taught: Corrected, theta: Codes, samples: Codes, known: Codes, output: int
) -> Codes:
    """The hidden words of the network of an output, which reads the known outputs before it."""
    corrected = taught.samples(theta, samples << SAMPLE_SHIFT)
    return taught.hidden(output, np.hstack([corrected, known_words(known[:, :output])]))


def equation(
    taught: Corrected, theta: Codes, samples: Codes, known: Codes, output: int
) -> tuple[Codes, Codes]:
    """What an output of a placement says at ``theta``, of several placements side by side.

    Equation: ``error = row . (theta sought - theta)``, ``row = (dy/dz x G, dy/dz O)`` with the
        standard deviations G and O of theta.

    samples, shape (placements, sensors): Codes of what the sensors read.
    known, shape (placements, outputs): Codes of the known outputs.

    Returns: The error, shape (placements,): the known output less the one found. The row, shape
        (placements, 2 sensors): the derivatives of the output by theta.
    """
    hidden = hidden_words(taught, theta, samples, known, output)
    error = known_words(known[:, output]) - taught.output(output, hidden)[:, 0]
    slopes = taught.slopes(output, hidden)
    by_gain = rounded(slopes * (samples << SAMPLE_SHIFT >> SHORT))
    gains, offsets = row_weights(taught)
    row = np.hstack([rounded(by_gain * gains), rounded(slopes * offsets)])
    return rounded(error << DROPPED), row


def row_weights(taught: Corrected) -> tuple[Codes, Codes]:
    """The weights of theta in a row: of a derivative times a sample, and of one alone."""
    gains = taught.gains << (ROW.frac + DROPPED - _TIMES_SAMPLE.frac - GAIN_WEIGHT)
    offsets = taught.offsets << (ROW.frac + DROPPED - SLOPE.frac - OFFSET_WEIGHT)
    return gains, offsets


def bounded(theta: Codes, wanted: Codes) -> tuple[Codes, NDArray[np.bool_]]:
    """The new theta, and whether the step is taken; the old one where it would leave its format.

    theta, wanted: shape (placements, 2 sensors).
    """
    inside = (wanted >= THETA.low) & (wanted <= THETA.high)
    fits = np.asarray(inside.all(axis=1), dtype=bool)
    return np.where(fits[:, np.newaxis], wanted, theta), fits


def lms_step(
    theta: Codes, error: Codes, row: Codes, step: int, leak: int
) -> tuple[Codes, NDArray[np.bool_]]:
    """Theta after an equation, and whether the step was taken.

    step, leak: The step in the format ``STEP``, and the leak of its output; see ``constants``.
    """
    moved = rounded(error * step)
    # With 28 fraction bits.
    by = moved[:, np.newaxis] * (row >> SHORT)
    wanted = (theta << DROPPED) + by - theta * leak
    return bounded(theta, (wanted + HALF_WORD) >> DROPPED)


def constants(taught: Corrected, codes: Codes, targets: Codes) -> Codes:
    """The constant step and the leak of each output, shape (outputs, 2).

    The step is half of the largest with which no equation overshoots. The leak is what theta times
    ``2**-DROPPED`` loses in each step, so that what no placement tells goes back to no drift. Steps
    and leaks end at the most likely theta if ``leak = step r^2 / n``, where n is the number of
    placements, and r^2 the mean square of the network's own errors. Here n is ``PLACEMENTS``.

    codes, shape (rows, sensors): Samples of a recording.
    targets, shape (rows, outputs): Its known outputs.
    """
    theta = np.zeros((len(codes), 2 * taught.sensors), dtype=np.int64)
    found = [equation(taught, theta, codes, targets, output) for output in range(taught.outputs)]
    longest = np.array([(ROW.to_real(row) ** 2).sum(axis=1).max() for _, row in found])
    # An output that no sensor moves has the largest step there is.
    least = 0.5 / STEP.to_real(np.array(STEP.high))
    steps = STEP.quantise(0.5 / np.maximum(longest, least))[0]
    squares = np.array([(ERROR.to_real(error) ** 2).mean() for error, _ in found])
    exact = STEP.to_real(steps) * squares / PLACEMENTS
    # Rounded so that their sum is the least above the exact one.
    leaks = np.diff(np.ceil(np.cumsum(exact) * (1 << DROPPED)), prepend=0).astype(np.int64)
    return np.stack([steps, np.minimum(leaks, MOST_LEAK)], axis=1)


class Pupil:
    """An engine that learns with LMS, from a reset on.

    taught: Its networks behind sensors that are corrected.
    constants: The step and the leak of each output; see ``golden.learning.gradient``.
    placements: How many placements it keeps; the next one takes the place of the oldest.

    theta, shape (2 sensors,): What is learned so far; see ``golden.learning.corrected``.
    steps, refused: How many steps were taken, and how many were not, because they would have left
        the range.
    changes: How often theta was changed.
    output: The output whose equation is next.
    """

    def __init__(
        self, taught: Corrected, constants: Sequence[Sequence[int]], placements: int
    ) -> None:
        self.taught = taught
        self.steps = self.refused = self.changes = 0
        self._constants = constants
        self._kept: deque[tuple[Codes, Codes]] = deque(maxlen=placements)
        self.theta: Codes = np.zeros(2 * taught.sensors, dtype=np.int64)
        # The placement and the output of the next equation.
        self._shown = self.output = 0

    @property
    def placements(self) -> int:
        return len(self._kept)

    @property
    def begins(self) -> bool:
        """Whether the next equation is the first of the oldest placement."""
        return self._shown == self.output == 0

    @property
    def codes(self) -> Codes:
        """Theta as it can be read, in codes of signals."""
        return self.theta >> OUTPUT_SHIFT

    def put(self, codes: Codes) -> None:
        """Use another theta, given as it can be read, from now on."""
        self.theta = codes << OUTPUT_SHIFT
        self.changes += 1

    def keep(self, samples: Codes, known: Codes) -> None:
        """Keep a placement, with which learning goes on.

        samples, shape (sensors,): Codes of what the sensors read.
        known, shape (outputs,): Codes of the known outputs.
        """
        self._kept.append((samples[np.newaxis], known[np.newaxis]))
        self._shown, self.output = len(self._kept) - 1, 0

    def step(self) -> bool:
        """Compute the next equation; returns whether its step was taken.

        It goes through all outputs of a placement, and then through those of the next one. Without
        placements nothing is computed, and no step is taken.
        """
        if not self._kept:
            return False
        before = self.theta[np.newaxis]
        found = equation(self.taught, before, *self._kept[self._shown], self.output)
        (self.theta,), (taken,) = lms_step(before, *found, *self._constants[self.output])
        self.steps += int(taken)
        self.changes += int(taken)
        self.refused += int(not taken)
        self.output = (self.output + 1) % self.taught.outputs
        if not self.output:
            self._shown = (self._shown + 1) % len(self._kept)
        return bool(taken)

    def process(self, frames: Codes) -> Codes:
        """The output codes of frames of samples, shape (frames, outputs), as it is taught now."""
        theta = np.broadcast_to(self.theta, (len(frames), len(self.theta)))
        return self.taught.process(theta, frames)
