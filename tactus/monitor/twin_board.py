"""A board that is made of twins, behind a pseudo-terminal instead of a serial port.

It sends packets as fast as is asked for. It answers images and lessons as the hardware does, and
its cable can be cut. ``PORT=twin`` is such a board at the packet rate of the real one, so that
everything is seen at its own speed, except that it learns slower.
"""

from __future__ import annotations

import os
import select
import threading
import time
import tty
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from golden.engine.image import Image
from golden.layers.argmax import Argmax
from golden.learning.gradient import Pupil
from golden.link.lesson_receiver import LessonReceiver
from golden.link.packets import IMAGE, SYNC, Frame, kind_byte
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.monitor.board import Board, Drift, nearest_row, samples_of
from tactus.scene import Scene
from tactus.scene.building import taught_of

# The board looks for something to do each so many seconds.
PAUSE = 0.01
# A board that learns does it for so many seconds between two packets. A step takes a computer far
# longer than the board, so there is no room for more packets.
LEARN_SECONDS = 0.02
_HEADER = 4


class TwinBoard:
    """A board on a pseudo-terminal that plays the recording of a scene, one row after the other.

    scene: The scene with the hardware, the networks and the recording.
    rate: Packets per second; with 0, as many as are read.
    hold: How many packets each row is played for.
    drift: How far its sensors have drifted since the recording.

    port: The path to open as a serial port.
    samples, shape (rows, sensors): Codes of what its sensors read in each row of the recording.
    lessons: What it does with lessons; None for a board that does not learn.
    """

    def __init__(
        self, scene: Scene, rate: float = 0.0, hold: int = 1, drift: Drift | None = None
    ) -> None:
        self.scene, self.rate, self.hold = scene, rate, hold
        self.layout = Board(scene, scene).layout
        self.samples = samples_of(scene, drift)
        self._visualisation = scene.visualisation
        self._row: int | None = None
        self._noise = b""
        self._error = False
        self._received = bytearray()
        self._folder = TemporaryDirectory()
        self.port = str(Path(self._folder.name) / "board")
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._ends: tuple[int, int] | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        core = scene.twin().core
        self.lessons = TwinLessons.of(scene, core) if isinstance(core, LearningEngine) else None
        self._engine = core if isinstance(core, Engine) and core.loaded else None
        # An engine that can be loaded computes nothing before an image comes.
        self._runs = self._engine is None
        self._compute()

    def __enter__(self) -> TwinBoard:
        self.mend()
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._stop.set()
        self._thread.join()
        self.cut()
        self._folder.cleanup()

    def start(self) -> None:
        """Run as if the image of the scene had been loaded."""
        self._runs = True

    def place(self, targets: Mapping[str, str | float]) -> None:
        """Stay at the recorded row whose outputs are nearest to these."""
        self._row = nearest_row(self.scene, targets)

    def noise(self, data: bytes) -> None:
        """Put bytes on the line, between two packets."""
        with self._lock:
            self._noise += data

    def cut(self) -> None:
        """Pull the plug."""
        with self._lock:
            ends, self._ends = self._ends, None
            Path(self.port).unlink(missing_ok=True)
            for end in ends or ():
                os.close(end)

    def mend(self) -> None:
        """Put the plug in again."""
        board, computer = os.openpty()
        tty.setraw(board)
        os.set_blocking(board, False)
        with self._lock:
            self._ends = (board, computer)
            Path(self.port).symlink_to(os.ttyname(computer))

    def _compute(self) -> None:
        rows = len(self.samples)
        # If an image has fewer outputs, the other ones stay as they are after a reset.
        self._outputs: Codes = np.zeros((rows, self.layout.outputs), dtype=np.int64)
        # One output has no winner.
        self._winners: Codes = np.zeros((rows, 2), dtype=np.int64)
        if self._visualisation:
            points = self._visualisation.load_profile.ramp.points
            self._profile: Codes = np.zeros((rows, points), dtype=np.int64)
        # How many changes of theta the outputs of each row know.
        self._changes: Codes = np.zeros(rows, dtype=np.int64)
        self._compute_rows(slice(rows))

    def _compute_rows(self, rows: slice) -> None:
        if self.lessons:
            outputs = self.lessons.pupil.process(self.samples[rows])
            self._changes[rows] = self.lessons.pupil.changes
        else:
            core = self._engine if self._engine else self.scene.twin().core
            outputs = core.process(self.samples[rows])
        self._outputs[rows, : outputs.shape[1]] = outputs
        if outputs.shape[1] > 1:
            winners = Argmax(SIGNAL, outputs.shape[1]).process(outputs)
            self._winners[rows] = np.stack(winners, axis=1)
        if self._visualisation:
            results = self._outputs[rows, list(self._visualisation.results)]
            self._ramp, self._profile[rows] = self._visualisation.load_profile.process(results)

    def _run(self) -> None:
        began, line = time.monotonic(), b""
        sent = computed = 0
        turn = True
        while not self._stop.is_set():
            line = self._exchange(line)
            late = time.monotonic() - began - sent / self.rate if self.rate else 0.0
            if self.lessons and self.lessons.busy and (turn or late < 0):
                self.lessons.learn_for(LEARN_SECONDS)
                # A packet that cannot be sent meanwhile is not sent later.
                began += max(0.0, late)
                turn = False
                continue
            turn = True
            if line:
                continue
            if late < 0:
                time.sleep(PAUSE)
                continue
            with self._lock:
                line, self._noise = self._noise, b""
            line += self.layout.to_bytes(self._frame(sent, computed))
            computed += self._runs
            sent += 1

    def _frame(self, number: int, computed: int) -> Frame:
        row = self._row
        if row is None:
            row = number // self.hold % len(self.samples)
        if self.lessons:
            self.lessons.read(self.samples[row])
            if self._changes[row] != self.lessons.pupil.changes:
                self._compute_rows(slice(row, row + 1))
        point = None
        if self._visualisation:
            at = number % len(self._ramp)
            point = (at, int(self._ramp[at]), int(self._profile[row, at]))
        flags = (
            *["frame_error"] * (not self._runs),
            *["image_error"] * self._error,
            *(self.lessons.flags() if self.lessons else ()),
        )
        samples = tuple(self.samples[row].tolist())
        outputs = tuple((self._outputs[row] * self._runs).tolist())
        winner = None
        if self.layout.decides:
            index, margin = (self._winners[row] * self._runs).tolist()
            winner = (index, margin)
        theta = self.lessons.element(number) if self.lessons else None
        return Frame(number % 256, flags, computed % 65536, samples, outputs, point, winner, theta)

    def _exchange(self, line: bytes) -> bytes:
        """Send what the line takes, take what has come, and return what is still to be sent."""
        with self._lock:
            if self._ends is None:
                time.sleep(PAUSE)
                return b""
            board = self._ends[0]
            pause = 0.0 if self.lessons and self.lessons.busy and not line else PAUSE
            reads, writes, _ = select.select([board], [board] if line else [], [], pause)
            data = os.read(board, 4096) if reads else b""
            if self.lessons:
                self.lessons.take(data)
            else:
                self._take(data)
            if not writes:
                return line
            try:
                return line[os.write(board, line) :]
            except BlockingIOError:
                return line

    def _take(self, data: bytes) -> None:
        """Take bytes from the computer, and load an image when all of it has come."""
        self._received += data
        start = self._received.find(bytes([SYNC, kind_byte(IMAGE)]))
        if start < 0:
            return
        del self._received[:start]
        length = int.from_bytes(self._received[2:_HEADER], "big")
        if len(self._received) < _HEADER + length or len(self._received) < _HEADER:
            return
        image = bytes(self._received[_HEADER : _HEADER + length])
        del self._received[: _HEADER + length]
        if self._engine is None:
            return
        found = self._engine.image_loader.judge(image)
        self._error, self._runs = found is None, found is not None
        if found is not None:
            before_last, words = found
            sizes = self._engine.image_loader
            inputs = (before_last + 2) % (1 << sizes.operand_addr_width)
            assert self._engine.loaded is not None, "an engine that can be reloaded holds an image"
            loaded = Image(self._engine.loaded.sizes, inputs, tuple(words))
            self._engine = self._engine.running(loaded)
            self._compute()


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
