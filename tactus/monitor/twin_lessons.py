"""What a board of twins does with lessons: it takes them, keeps placements, and learns."""

from __future__ import annotations

import time

import numpy as np

from golden.learning.pupil import Pupil
from golden.link.lesson_receiver import LessonReceiver
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.scene import Scene
from tactus.scene.building import taught_of

# After so many seconds without a byte a lesson is dropped. The board waits for less than a
# millisecond, but the system may pause between two bytes of a computer that sends them together.
IDLE_SECONDS = 0.2


class TwinLessons:
    """The part of a board of twins that learns.

    learn: Whether it is to learn, as the last right lesson says.
    """

    def __init__(self, pupil: Pupil) -> None:
        self.pupil = pupil
        self.learn = False
        # The known outputs, or the theta, that wait for the end of a frame.
        self._known: Codes | None = None
        self._theta: Codes | None = None
        self._lesson_error = self._learn_error = False
        # Bytes come one after the other here, so a clock without one ends a packet.
        outputs, elements = pupil.taught.outputs, len(pupil.theta)
        self._receiver = LessonReceiver(outputs, elements, idle_clocks=1)
        self._packet = b""
        self._place, self._byte_at = 0, 0.0

    @classmethod
    def of(cls, scene: Scene, core: LearningEngine) -> TwinLessons:
        """The lessons of a scene's engine."""
        return cls(Pupil(*taught_of(scene), core.placements))

    @property
    def busy(self) -> bool:
        """Whether there is something to learn now."""
        return self.learn and self.pupil.placements > 0

    def take(self, data: bytes) -> None:
        """Take the bytes that have come from the computer, maybe none."""
        now = time.monotonic()
        if not data and self._packet and now - self._byte_at > IDLE_SECONDS:
            # Before the kind is known, it is no lesson.
            self._lesson_error |= self._place > 1
            self._packet = b""
        for byte in data:
            self._packet += bytes([byte])
            self._byte_at = now
            self._judge()

    def read(self, samples: Codes) -> None:
        """A frame is computed from these samples; known outputs that wait are kept with them.

        Theta that waits is in use behind it. With a sample at an end of its range both are refused.
        """
        if np.isin(samples, (SIGNAL.low, SIGNAL.high)).any():
            self._lesson_error |= self._known is not None or self._theta is not None
            self._known = self._theta = None
        if self._known is not None:
            self.pupil.keep(samples, self._known)
        if self._theta is not None:
            self.pupil.put(self._theta)
        self._known = self._theta = None

    def element(self, number: int) -> tuple[int, int]:
        """Number and code of the element of theta in a packet of this number."""
        codes = self.pupil.codes
        return number % len(codes), int(codes[number % len(codes)])

    def learn_for(self, seconds: float) -> None:
        """Compute equations for about so long."""
        ends = time.monotonic() + seconds
        while time.monotonic() < ends:
            self._learn_error |= not self.pupil.step()

    def flags(self) -> list[str]:
        """The flags of the next packet."""
        errors = {"lesson_error": self._lesson_error, "learn_error": self._learn_error}
        self._lesson_error = self._learn_error = False
        return [name for name, on in {**errors, "learning": self.learn}.items() if on]

    def _judge(self) -> None:
        """Look at the packet so far. Behind it a frame ends, so that its codes leave."""
        count = len(self._packet)
        none = np.zeros(count, dtype=np.int64)
        behind = np.zeros(1 + self._receiver.codes, dtype=np.int64)
        ends = np.append(none, behind)
        ends[count] = 1
        taught = self._receiver.process(
            np.append(none + 1, behind),
            np.append(list(self._packet), behind),
            ends,
            np.append(none, behind + 1),
            np.append(none, behind),
        )
        self._place = int(taught.place[count])
        if self._place:
            return
        self._packet = b""
        self._lesson_error |= bool(taught.lesson_error[count])
        if taught.lesson_error[count] or taught.place[count - 1] < self._receiver.packet_bytes - 1:
            return
        self.learn = bool(taught.learn[count])
        # A packet takes the place of one that waits.
        self._known = self._theta = None
        codes = taught.target_data[count + 1 :][taught.target_valid[count + 1 :]]
        if taught.target_theta[count + 1 :].any():
            self._theta = codes
        elif len(codes):
            self._known = codes
