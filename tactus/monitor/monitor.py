"""Turns what a board sends into what is shown: values, their course, a profile, and faults."""

import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.link.decoder import FAULTS, FRAMES, Decoder, fault
from golden.link.packets import FLAGS, Frame
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.monitor.board import Board
from tactus.monitor.csv_file import GrowingCsv
from tactus.monitor.lessons import Lessons
from tactus.monitor.line import Line

# The columns of a recording that stand before those of the scene.
HEAD = ("seconds", "packet", "computed", "flags")
# The page shows the outputs of the last ``SHOWN_SECONDS``, with a point every ``POINT_SECONDS``.
SHOWN_SECONDS, POINT_SECONDS = 30.0, 0.05
# A rate is counted over ``RATE_SECONDS``, or over ``RATE_ARRIVALS`` if arrivals are rarer.
RATE_SECONDS, RATE_ARRIVALS = 1.0, 5
LIT_SECONDS = 1.0
# The least number of seconds between two messages of the same kind.
PAUSE = 10.0
# The most lines that the page shows.
MOST_LINES = 30

_COUNTS = 1 << 16
NO_DECISION = ["", ""]

NOT_SENT = "a lesson was not sent, because the line was cut"
FLAG_TEXTS = {
    "converter_error": "the converter is missing or stuck: no frame is made of what it sends",
    "frame_error": "a frame was refused: none is computed before an image is loaded",
    "image_error": "an image was cut on its way, or is not for this hardware",
    "line_error": "the board received a byte without a stop bit: another baud rate, or noise",
    "lesson_error": "a lesson was damaged on its way, or its known outputs were not taken",
    "learn_error": "a step of learning would have left the range, and was not taken",
}


def csv_columns(board: Board) -> list[str]:
    return [*HEAD, *board.columns, *board.decision_columns]


class Monitor:
    """Takes the bytes that come over a line, and gives at any time what is to be shown.

    say: Called with each line for a terminal.
    csv: A file to which every frame is appended, with ``csv_columns``.
    clock: Gives a time in seconds.

    lessons: The lessons for the board; None for one that does not learn.
    """

    def __init__(
        self,
        board: Board,
        say: Callable[[str], None],
        csv: GrowingCsv | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.board, self.csv = board, csv
        self.lessons = Lessons(board) if board.instrument.learns else None
        self.decoder = Decoder(board.layout)
        self.computed = 0
        # What was said, with the time of day; the newest comes first.
        self.messages: deque[str] = deque(maxlen=MOST_LINES)
        self._said: dict[str, float] = {}
        self._say, self._clock = say, clock
        self._lock = threading.Lock()
        self._told: Counter[str] = Counter()
        self._began = self._packet_at = clock()
        self._line = "waiting"
        self._newest: Frame | None = None
        self._values: Real = np.empty(0)
        self._course: deque[tuple[float, list[float]]] = deque()
        self._arrivals: deque[tuple[float, int, int]] = deque()
        self._lit = dict.fromkeys(FLAGS, -LIT_SECONDS)
        self._flagged = dict.fromkeys(FLAGS, 0)
        visualisation = board.hardware.visualisation
        points = visualisation.load_profile.ramp.points if visualisation else 0
        self._profile: list[tuple[float, float] | None] = [None] * points

    def listen(self, line: Line, until: Callable[[], bool]) -> None:
        """Take what comes until ``until`` is true; report a cut cable and wait until it is back."""
        while not until():
            if self.lessons:
                self._send(line, self.lessons)
            data = line.read()
            with self._lock:
                if frames := self.decoder.feed(data):
                    self._take_frames(frames, self._clock())
                self._tell_faults()
                self._watch(line)

    def actions(self) -> dict[str, Callable[[Any], object]]:
        """What the page may ask for, by its path; each takes what was sent with it."""
        if self.lessons is None:
            return {}
        tour = {"/next": self._next} if self.lessons.tour else {}
        return {"/teach": self.teach, "/moved": self.lessons.moved, **tour}

    def _next(self, _: object) -> dict[str, str]:
        """The known outputs of the next placement of the tour, where the simulated board is now."""
        assert self.lessons is not None, "only a board that learns is taught"
        assert self.lessons.tour is not None, "only a simulated board goes on by itself"
        with self._lock:
            self.lessons.moved()
            return next(self.lessons.tour)

    def teach(self, request: Mapping[str, Any]) -> None:
        """Send the board a lesson, which ``listen`` does; see ``Lessons.ask``.

        It may be called from any thread.
        """
        assert self.lessons is not None, "only a board that learns is taught"
        with self._lock:
            if self._line != "packets":
                raise InputError(
                    "a lesson is not sent: no frames come from the board, expected some, with one "
                    "of which the known outputs are kept"
                )
            self.lessons.ask(request, self._learning)

    def _send(self, line: Line, lessons: Lessons) -> None:
        """Send the lesson that waits, if one does; only this thread writes to the line."""
        with self._lock:
            packet, known = lessons.next()
        if not packet:
            return
        try:
            line.write(packet)
        except InputError:
            with self._lock:
                self._tell(NOT_SENT)
            return
        if known is not None:
            with self._lock:
                lessons.shown(known, self._values, self._clock())

    @property
    def _learning(self) -> bool:
        """Whether the board learns, as the newest packet says."""
        return self._newest is not None and "learning" in self._newest.flags

    def _take_frames(self, frames: list[Frame], now: float) -> None:
        values = self.board.in_units(frames)
        last = self._newest
        computed = 0
        for frame in frames:
            computed += (frame.count - last.count) % _COUNTS if last else 1
            for flag in frame.flags:
                self._lit[flag] = now
                self._flagged[flag] += 1
            if frame.point:
                number, *codes = frame.point
                if number < len(self._profile):
                    x, y = (float(value) for value in SIGNAL.to_real(np.array(codes)))
                    self._profile[number] = (x, y)
                else:
                    what = f"the profile has a point {number}"
                    self._beyond("point", what, len(self._profile), "hardware")
            if frame.winner and frame.winner[0] >= len(self.board.scene.outputs):
                what = f"the largest output is number {frame.winner[0]}"
                self._beyond("winner", what, len(self.board.scene.outputs), "networks")
            if frame.theta and self.lessons:
                self.lessons.told(*frame.theta)
            last = frame
        for flag, text in FLAG_TEXTS.items():
            if self._lit[flag] == now:
                self._repeat(flag, text)
        self.computed += computed
        self._newest, self._values = last, values[-1]
        self._packet_at = now
        self._arrivals.append((now, len(frames), computed))
        outputs = [float(value) for value in values[-1, len(self.board.scene.sensors) :]]
        if not self._course or now - self._course[-1][0] >= POINT_SECONDS:
            self._course.append((now, outputs))
        while now - self._course[0][0] > SHOWN_SECONDS:
            self._course.popleft()
        if self.csv:
            self.csv.append(self._rows(frames, values, now))

    def _beyond(self, kind: str, what: str, count: int, own: str) -> None:
        """Report a number in a packet that this scene does not have."""
        expected = f"expected 0 to {count - 1}: the board runs the {own} of another scene"
        self._repeat(kind, f"{what}, {expected}")

    def _rows(self, frames: list[Frame], values: Real, now: float) -> list[Sequence[object]]:
        return [
            [
                *(f"{now - self._began:.3f}", frame.number, frame.count, " ".join(frame.flags)),
                *self.board.texts(row),
                *self.board.decision(frame),
            ]
            for frame, row in zip(frames, values, strict=True)
        ]

    def _tell_faults(self) -> None:
        """Report each kind of fault that has come again since its last report, if one is due."""
        for kind, count in self.decoder.tally.items():
            text = fault(kind, count, self._told[kind])
            if text and self._repeat(kind, text):
                self._told[kind] = count

    def _watch(self, line: Line) -> None:
        """Report it when the line is cut, comes back, falls silent, or carries packets again."""
        now = self._clock()
        if line.cut:
            if self._line != "cut":
                self.decoder.restart()
                self._newest = None
                if self.lessons:
                    self.lessons.forget()
                self._arrivals.clear()
                # The course has a gap here, because nothing is known of the time of the cut.
                self._course.append((now, []))
                self._tell(f"the line was cut: {line.cut}; waiting for {line.label}")
            self._line = "cut"
        elif self._line == "cut":
            self._tell(f"{line.label} is back")
            self._line, self._packet_at = "waiting", now
        elif now - self._packet_at > line.silence:
            if self._line != "silent":
                self._tell(f"no packet for {line.silence:g} s")
            self._line = "silent"
        elif self._newest is not None:
            if self._line == "silent":
                self._tell("packets come again")
            idle = len(self._arrivals) >= RATE_ARRIVALS and not self.rates()[1]
            self._line = "idle" if idle else "packets"

    def _repeat(self, kind: str, text: str) -> bool:
        """Print a message, unless one of its kind was printed in the last ``PAUSE`` seconds."""
        now = self._clock()
        due = now - self._said.get(kind, -PAUSE) >= PAUSE
        if due:
            self._said[kind] = now
            self._tell(text)
        return due

    def _tell(self, text: str) -> None:
        self.messages.appendleft(f"{time.strftime('%H:%M:%S')} {text}")
        self._say(self.messages[0])

    def rates(self) -> tuple[float, float]:
        """The recent rates of packets and of computed frames, both per second."""
        now, arrivals = self._clock(), self._arrivals
        while len(arrivals) > RATE_ARRIVALS and now - arrivals[1][0] > RATE_SECONDS:
            arrivals.popleft()
        if len(arrivals) < 2 or now == arrivals[0][0]:
            return 0.0, 0.0
        # The first arrival only marks when the time begins, so it is not counted.
        packets, computed = (sum(a[n] for a in arrivals) - arrivals[0][n] for n in (1, 2))
        return packets / (now - arrivals[0][0]), computed / (now - arrivals[0][0])

    def line(self) -> str:
        packets, _ = self.rates()
        shown = [f"{packets:.3g} packets a second, {self.decoder.tally['missed']} missed"]
        if self._line in ("packets", "idle"):
            shown += [f"{item['name']} {item['text']}" for item in self._decision()]
            texts = self.board.texts(self._values)[len(self.board.scene.sensors) :]
            shown += [f"{n} {t}" for n, t in zip(self.board.scene.outputs, texts, strict=True)]
        return ", ".join(shown)

    def _decision(self) -> list[dict[str, str]]:
        board, newest = self.board, self._newest
        texts = board.decision(newest) if newest else NO_DECISION
        return [
            {"name": name, "text": text}
            for name, text in zip(board.decision_columns, texts, strict=False)
        ]

    def state(self) -> dict[str, Any]:
        with self._lock:
            return self._state()

    def _state(self) -> dict[str, Any]:
        now, board, tally = self._clock(), self.board, self.decoder.tally
        scene, known = board.scene, self._newest
        texts = board.texts(self._values) if len(self._values) else [""] * len(board.columns)
        columns: list[dict[str, Any]] = [
            {"name": name, "text": text, "unit": scene.units.get(name, ""), "factor": scale.factor}
            for name, text, scale in zip(
                board.columns, texts, scene.scales(board.columns), strict=True
            )
        ]
        sensors, outputs = columns[: len(scene.sensors)], columns[len(scene.sensors) :]
        if known:
            for column, code in zip(sensors, known.samples, strict=True):
                column["code"] = code
        for name, column in zip(scene.outputs, outputs, strict=True):
            scale = board.millimetres(name)
            value = self._values[board.columns.index(name)] if scale and column["text"] else None
            column["mm"] = "" if value is None else f"{value * scale:.1f}"
        packets, computed = self.rates()
        return {
            "scene": scene.name,
            "line": self._line,
            "decision": self._decision(),
            "sensors": sensors,
            "outputs": outputs,
            "course": [[round(t - now, 3), *values] for t, values in self._course],
            "seconds": SHOWN_SECONDS,
            "profile": [p for p in self._profile if p] if _position(board) else [],
            "profile_mm": board.millimetres(_position(board)),
            "packets": tally[FRAMES],
            "packets_a_second": packets,
            "computed": self.computed,
            "computed_a_second": computed,
            **{kind: tally[kind] for kind in FAULTS},
            "flags": [
                {"name": name, "lit": now - self._lit[name] < LIT_SECONDS, "count": count}
                for name, count in self._flagged.items()
                # A board of other hardware may set flags that this one does not have.
                if name in FLAG_TEXTS and (count or name in board.flags)
            ],
            "learning": self.lessons and self.lessons.state(self._course, now, self._learning),
            "messages": list(self.messages),
            "recorded": self.csv.rows if self.csv else 0,
            "recording": str(self.csv.path) if self.csv else "",
        }


def _position(board: Board) -> str:
    """The output over which the profile is drawn; empty where the scene has no profile."""
    visualisation, outputs = board.hardware.visualisation, board.scene.outputs
    if visualisation is None or max(visualisation.results) >= len(outputs):
        return ""
    return outputs[visualisation.results[1]]
