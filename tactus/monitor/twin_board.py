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
from golden.link.packets import IMAGE, SYNC, Frame, kind_byte
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.monitor.board import Board
from tactus.monitor.placements import Drift, nearest_row, samples_of
from tactus.monitor.twin_lessons import TwinLessons
from tactus.scene import Scene

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
        """Compute the outputs and profiles of every row."""
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
        """Compute the outputs and profiles of some rows."""
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
