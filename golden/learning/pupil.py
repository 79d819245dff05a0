"""What an engine that learns holds, and what it computes, without its clocks.

``golden.learning.timeline`` says in which clock each thing happens. Here a frame, a placement and a
step follow each other as whole things, so it is some hundred times as fast.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np

from golden.engine.formats import OUTPUT_SHIFT
from golden.learning.corrected import Corrected
from golden.learning.gradient import Gradient, Lesson
from golden.numbers.fixed import Codes


class Pupil:
    """An engine that learns with LMS, from a reset on.

    taught: Its networks behind sensors that are corrected.
    constants: The step and the leak of each output; see ``golden.learning.gradient``.
    placements: How many placements it keeps; the next one takes the place of the oldest.

    theta, shape (2 sensors,): What is learned so far; see ``golden.learning.corrected``.
    steps, refused: How many steps were taken, and how many were not, because they would have left
        the range.
    changes: How often theta was changed.
    """

    def __init__(
        self, taught: Corrected, constants: Sequence[Sequence[int]], placements: int
    ) -> None:
        self.taught = taught
        self.steps = self.refused = self.changes = 0
        self._rule = Gradient(taught, np.array(constants))
        self._kept: deque[Lesson] = deque(maxlen=placements)
        self.theta: Codes = np.zeros(2 * taught.sensors, dtype=np.int64)
        # The placement and the output of the next equation.
        self._shown = self._output = 0

    @property
    def placements(self) -> int:
        """How many placements are kept now."""
        return len(self._kept)

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
        self._kept.append(Lesson(samples[np.newaxis, np.newaxis], known[np.newaxis, np.newaxis]))
        self._shown, self._output = len(self._kept) - 1, 0

    def step(self) -> bool:
        """Compute the next equation; returns whether its step was taken.

        It goes through all outputs of a placement, and then through those of the next one. Without
        placements nothing is computed, and no step is taken.
        """
        if not self._kept:
            return False
        lesson = self._kept[self._shown]
        before = self.theta[np.newaxis]
        (self.theta,), (taken,) = self._rule.step(lesson, before, 0, self._output)
        self.steps += int(taken)
        self.changes += int(taken)
        self.refused += int(not taken)
        self._output = (self._output + 1) % self.taught.outputs
        if not self._output:
            self._shown = (self._shown + 1) % len(self._kept)
        return bool(taken)

    def process(self, frames: Codes) -> Codes:
        """The output codes of frames of samples, shape (frames, outputs), as it is taught now."""
        theta = np.broadcast_to(self.theta, (len(frames), len(self.theta)))
        return self.taught.process(theta, frames)
