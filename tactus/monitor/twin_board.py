"""A board that is made of twins: ``PORT=twin``.

It sends the packets that the hardware would send, at its rate, and answers images and lessons as
the hardware does. So everything is seen at its own speed, except that it learns slower.
"""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from golden.input_error import InputError
from golden.layers.argmax import Argmax
from golden.learning.gradient import Pupil
from golden.link.lesson_receiver import LessonReceiver
from golden.link.packets import Frame, image_packet, lesson_packet
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.monitor.board import Board
from tactus.scene import Scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.labels import one_hot
from tactus.scene.scale import signals
from tactus.scene.vectors import read_recorded

TWIN = "twin"
# The longest time in seconds that one call waits for bytes, or for a port that is gone.
PAUSE = 0.1
# A board that learns does it for so many seconds between two packets. A step takes a computer far
# longer than the board, so there is no room for more packets.
LEARN_SECONDS = 0.02
# Packets that were not read in time wait, but no more of them are read at once.
MOST_PACKETS = 100
IMAGE_HEADER = len(image_packet(b"\0")) - 1

# Outputs; winner and margin; positions and heights of a profile, where one is built.
Results = tuple[list[int], list[int], tuple[Codes, Codes] | None]


def nearest_row(scene: Scene, targets: Mapping[str, str | float]) -> int:
    """The recorded row whose outputs are nearest to these; each counts in parts of its range.

    With classes it is the first row of the label that is given for their column.
    """
    if scene.labels and scene.classes in targets:
        label = str(targets[scene.classes])
        if label not in scene.labels:
            raise InputError(
                f"{scene.path}: data.classes: got no row of {label!r}, expected one of "
                f"{', '.join(scene.labels)}: a simulated board can only be touched as in its "
                "recording"
            )
        targets = dict(zip(scene.outputs, one_hot([label], scene.labels)[0].tolist(), strict=True))
    for name in targets:
        if name not in scene.outputs:
            raise InputError(
                f"{scene.path}: data.outputs: got no {name!r}, expected that of a placement: a "
                "simulated board can only be touched at placements of its recording"
            )
    recorded = read_recorded(scene).targets[:, [scene.outputs.index(name) for name in targets]]
    ranges = np.ptp(recorded, axis=0)
    asked = np.array([float(value) for value in targets.values()])
    far = (recorded - asked) / np.where(ranges > 0, ranges, 1.0)
    return int(np.argmin((far**2).sum(axis=1)))


class TwinBoard:
    """A board with its line, which plays the recording of a scene, one row after the other.

    It is used as a ``SerialLine`` is, whose cable nobody cuts.

    scene: The scene with the hardware, the networks and the recording.
    rate: Packets per second; with 0, one whenever the line is read.
    hold: How many packets each row is played for.
    drift, seed: Standard deviations of the gains, and of the offsets as signals, by which the
        sensors have drifted since the recording; gains and offsets are drawn from the seed.

    samples, shape (rows, sensors): Codes of what its sensors read in each row of the recording.
    lessons: What it does with lessons; None for a board that does not learn.
    """

    label, cut = TWIN, ""
    silence, patience = 2.0, 10.0

    def __init__(
        self,
        scene: Scene,
        rate: float = 0.0,
        hold: int = 1,
        drift: Disturbance | None = None,
        seed: int = 1,
    ) -> None:
        board = Board(scene, scene)
        self.scene, self.rate, self.hold = scene, rate, hold
        self.layout, self.baud = board.layout, board.baud
        read = signals(read_recorded(scene).sensors, scene.scales(scene.sensors))
        if drift:
            read = drift.of(read, np.random.default_rng(seed))
        self.samples: Codes = SIGNAL.quantise(read, "readings")[0]
        self._visualisation = scene.visualisation
        # The changes of theta until a row of the recording was computed, and what it becomes.
        self._results: dict[int, tuple[int, Results]] = {}
        self._row: int | None = None
        self._sent = self._computed = 0
        self._next = time.monotonic()
        self._core = core = board.instrument.core
        self.lessons = None
        if isinstance(core, LearningEngine):
            self.lessons = TwinLessons(core.program.pupil())
        # An engine that can be loaded computes nothing before an image comes.
        self._runs = not (isinstance(core, Engine) and core.loaded)
        self._error = False

    def __enter__(self) -> TwinBoard:
        return self

    def __exit__(self, *error: object) -> None:
        """Nothing is open."""

    def place(self, targets: Mapping[str, str | float]) -> None:
        """Stay at the recorded row whose outputs are nearest to these."""
        self._row = nearest_row(self.scene, targets)

    def drop(self) -> None:
        """Forget the packets that are due."""
        self._next = max(self._next, time.monotonic())

    def read(self) -> bytes:
        """The packets that are due; none if that takes longer than ``PAUSE``."""
        # There is something to learn now.
        if self.lessons and self.lessons.learn and self.lessons.pupil.placements:
            self.lessons.learn_for(LEARN_SECONDS)
            # A packet that cannot be sent meanwhile is not sent later.
            self.drop()
        late = time.monotonic() - self._next
        if late < 0:
            time.sleep(min(-late, PAUSE))
        if late < -PAUSE:
            return b""
        count = 1 + min(int(max(late, 0) * self.rate), MOST_PACKETS)
        self._next += count / self.rate if self.rate else 0
        return b"".join(self.layout.to_bytes(self._frame()) for _ in range(count))

    def write(self, data: bytes) -> None:
        """Take a packet: a lesson, or an image."""
        if self.lessons:
            self.lessons.take(data)
        elif isinstance(self._core, Engine) and self._core.loaded:
            image = self._core.received(data[IMAGE_HEADER:])
            self._error, self._runs = image is None, image is not None
            if image is not None:
                self._core = self._core.running(image)
                self._results.clear()

    def _result(self, row: int) -> Results:
        pupil = self.lessons.pupil if self.lessons else None
        changes = pupil.changes if pupil else 0
        if row not in self._results or self._results[row][0] != changes:
            (outputs,) = (pupil or self._core).process(self.samples[[row]])
            # One output has no winner.
            winner = [0, 0]
            if len(outputs) > 1:
                winner = [int(part) for part in Argmax(SIGNAL, len(outputs)).process(outputs)]
            # If an image has fewer outputs, the other ones stay as they are after a reset.
            outputs = np.append(outputs, np.zeros(self.layout.outputs - len(outputs), np.int64))
            profile = None
            if shown := self._visualisation:
                profile = shown.load_profile.process(outputs[list(shown.results)])
            self._results[row] = changes, (outputs.tolist(), winner, profile)
        return self._results[row][1]

    def _frame(self) -> Frame:
        number, row = self._sent, self._row
        if row is None:
            row = number // self.hold % len(self.samples)
        flags = ["frame_error"] * (not self._runs) + ["image_error"] * self._error
        theta = point = winner = None
        outputs, best, profile = self._result(row)
        if self.lessons:
            self.lessons.read(self.samples[row])
            flags += self.lessons.flags()
            theta = self.lessons.element(number)
        if profile:
            at = number % len(profile[0])
            point = at, *(int(part[at]) for part in profile)
        if self.layout.decides:
            winner = (best[0] * self._runs, best[1] * self._runs)
        samples = tuple(self.samples[row].tolist())
        count = self._computed % 65536
        self._sent += 1
        self._computed += self._runs
        shown = samples, tuple(code * self._runs for code in outputs)
        return Frame(number % 256, tuple(flags), count, *shown, point, winner, theta)


class TwinLessons:
    """The part of a board of twins that learns.

    learn: Whether it is to learn, as the last right lesson says.
    """

    def __init__(self, pupil: Pupil) -> None:
        self.pupil = pupil
        self.learn = False
        self._lesson_error = self._learn_error = False
        # The bytes of a packet come together, so a clock without one ends it.
        self._receiver = LessonReceiver(pupil.taught.outputs, len(pupil.theta), idle_clocks=1)
        # What has come since the frame before, in each clock a byte or -1. A packet that stands for
        # all earlier ones comes first.
        self._received: list[int] = []
        self._taught: dict[str, Codes] | None = None

    def take(self, data: bytes) -> None:
        """Take a packet from the computer; its known outputs or its theta wait for a frame."""
        self._received += [*data, -1]
        column = np.append(self._received, [-1] * (1 + self._receiver.codes))
        ends = np.arange(len(column)) == len(self._received)
        none = np.zeros(len(column))
        self._taught = self._receiver.process(column >= 0, column, ends, none + 1, none)
        self.learn = bool(self._taught["learn"][-1])

    def read(self, samples: Codes) -> None:
        """End a frame that was computed from these samples; known outputs that wait are kept.

        Theta that waits is in use from then on. With a sample at an end of its range both are
        refused.
        """
        taught, self._taught = self._taught, None
        if taught is None:
            return
        self._received = [*lesson_packet(self._receiver.codes, self.learn), -1]
        codes = taught["target_data"][taught["target_valid"] == 1]
        refused = len(codes) > 0 and np.isin(samples, (SIGNAL.low, SIGNAL.high)).any()
        self._lesson_error |= bool(taught["lesson_error"].any() or refused)
        if refused or not len(codes):
            return
        if taught["target_theta"].any():
            self.pupil.put(codes)
        else:
            self.pupil.keep(samples, codes)

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
        errors = {"lesson_error": self._lesson_error, "learn_error": self._learn_error}
        self._lesson_error = self._learn_error = False
        return [name for name, on in {**errors, "learning": self.learn}.items() if on]
