"""The lessons that a monitor gives to a board that learns."""

import threading
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from itertools import cycle
from typing import Any

import numpy as np

from golden.engine.formats import OUTPUT_SHIFT
from golden.input_error import InputError
from golden.learning.corrected import THETA
from golden.link.packets import lesson_packet
from golden.networks.learning_engine import LearningEngine
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.monitor.board import Board
from tactus.monitor.twin_board import TwinBoard
from tactus.recalibration.fit import fit
from tactus.recalibration.outlook import proposed
from tactus.recalibration.sensitivity import Placements, Sensitivity
from tactus.scene.disturbance import zero_signals
from tactus.scene.scale import readings, signals
from tactus.scene.vectors import error_scale

# A correction beyond so many standard deviations of the expected drift is hardly a drift.
MOST_DRIFT = 3.0
# The code of an element of theta that is 1.
ONE = 1 << (THETA.frac - OUTPUT_SHIFT)


def tour_of(board: Board, simulated: TwinBoard) -> Iterator[dict[str, str]]:
    """Place a simulated board where ``make recalibrate`` proposes, again and again.

    Gives the known outputs of each placement as texts.
    """
    scene = board.scene
    recorded = Sensitivity.of(scene, np.zeros(len(scene.sensors)))

    def placed(row: int) -> dict[str, str]:
        targets = scene.in_units(scene.vectors().targets[row])
        known = dict(zip(scene.outputs, targets.tolist(), strict=True))
        simulated.place(known)
        return {name: f"{value:g}" for name, value in known.items()}

    # Unlike a generator it goes on behind a placement that is refused.
    return map(placed, cycle(one.row for one in proposed(recorded)))


class Lessons:
    """The lessons that wait to be sent, and the placements that were shown.

    board: A board that learns.

    count: How many placements were shown.
    tour: The placements of a simulated board; see ``tour_of``.
    """

    def __init__(self, board: Board) -> None:
        core = board.instrument.core
        assert isinstance(core, LearningEngine), "a board that learns has one"
        self.board, self.places = board, core.placements
        self._taught = core.program.taught
        self.count = 0
        self.tour: Iterator[dict[str, str]] | None = None
        # Packets, each with the known outputs in it, in their units; None without any.
        self._waiting: deque[tuple[bytes, Real | None]] = deque()
        # Readings, known outputs, and errors of the outputs then. The board keeps no more either.
        self._shown: deque[tuple[Real, Real, Real]] = deque(maxlen=core.placements)
        self._there: Real | None = None
        self._since = 0.0
        self._learn: bool | None = None
        # The elements of theta, as packets told them last.
        self._theta: dict[int, int] = {}
        # How many placements were shown when ``make recalibrate`` had found this theta.
        self._found: tuple[int, list[int]] = (0, [])

    def told(self, number: int, code: int) -> None:
        """Note an element of theta."""
        self._theta[number] = code

    def forget(self) -> None:
        """What the board told of theta may be that of another board, or of before a reset."""
        self._theta = {}

    def ask(self, request: Mapping[str, Any], learning: bool) -> None:
        """Take a request for a lesson, which then waits to be sent.

        request: What the page sends. It may have the values of all outputs as texts under
            ``known``, or what a file has as theta under ``theta``, and whether the board is to
            learn from now on under ``learn``.
        learning: Whether the board learns now. It goes on so if nothing else was asked for.
        """
        learn = request.get("learn", learning if self._learn is None else self._learn)
        if not isinstance(learn, bool):
            raise InputError(f"learn: got {learn!r:.40}, expected true or false")
        what, values, scene = "known", None, self.board.scene
        codes: list[int] = []
        if "known" in request:
            codes = self.board.known_codes(request["known"])
            values = readings(SIGNAL.to_real(codes), scene.scales(scene.outputs))
        elif "theta" in request:
            what, codes = "theta", self._right_theta(request["theta"])
        # Only what is right changes anything.
        self._learn = learn
        count = self.board.instrument.lesson_receiver.codes
        self._waiting.append((lesson_packet(count, learn, codes, what), values))

    def _right_theta(self, theta: object) -> list[int]:
        count = self.board.instrument.elements
        expected = f"expected {count} whole numbers from {SIGNAL.low} to {SIGNAL.high}"
        if not isinstance(theta, list):
            raise InputError(f"theta: got {theta!r:.40}, {expected}")
        right = [type(one) is int and SIGNAL.low <= one <= SIGNAL.high for one in theta]
        if len(theta) != count or not all(right):
            raise InputError(f"theta: got {len(theta)} values, {theta!r:.40}, {expected}")
        return theta

    def next(self) -> tuple[bytes, Real | None]:
        """The packet that is to be sent now, with its known outputs; an empty one if none waits."""
        return self._waiting.popleft() if self._waiting else (b"", None)

    def shown(self, known: Real, values: Real, now: float) -> None:
        """Note that known outputs were sent, and readings and outputs before, in their units."""
        self.count += 1
        read, outputs = np.split(values, [len(self.board.scene.sensors)])
        self._shown.append((read, known, outputs - known))
        self._there, self._since = known, now
        # No packet is lost meanwhile.
        work = self.count, [*self._shown]
        threading.Thread(target=self._recalibrate, args=work, daemon=True).start()

    def moved(self, _: object = None) -> None:
        """The load is no longer where it was shown."""
        self._there = None

    @property
    def theta(self) -> list[int]:
        """The codes of theta, in their order, as packets told them last; none before all came."""
        count = self.board.instrument.elements
        return [self._theta[n] for n in range(count)] if len(self._theta) == count else []

    def _recalibrate(self, count: int, shown: list[tuple[Real, Real, Real]]) -> None:
        """Note the codes of the theta that ``make recalibrate`` finds from these placements.

        It is the most likely one, so where placements tell little of a sensor it stays near 0.
        """
        codes = np.clip(np.rint(ONE * self._fitted(shown)), SIGNAL.low, SIGNAL.high)
        self._found = max(self._found, (count, [int(code) for code in codes]))

    def _fitted(self, shown: list[tuple[Real, Real, Real]]) -> Real:
        scene = self.board.scene
        read, known, _ = map(np.array, zip(*shown, strict=True))
        scales = scene.scales(scene.outputs)
        factors = [scale.factor for scale in scales]
        size = error_scale(known, scene.outputs, scene.full_scale) / factors
        placements = Placements(
            signals(read, scene.scales(scene.sensors)),
            signals(known, scales),
            # The error of an output of 0 without a full scale has no size of its own.
            np.maximum(size, SIGNAL.to_real(1)),
            np.ones(len(shown)),
        )
        sensors = np.array([scale.factor for scale in scene.scales(scene.sensors)])
        recorded = Sensitivity.of(scene, scene.training.disturbance.noise / sensors)
        theta = fit(recorded, placements).theta
        # Its gains are of readings; those of a board are of signals, whose 0 may be elsewhere.
        gains, offsets = np.split(theta, 2)
        moved = zero_signals(scene) * recorded.gain * gains / recorded.offset
        return np.concatenate([gains, offsets + moved])

    def _corrections(self) -> list[dict[str, str]]:
        """What theta does to each sensor: the gain in percent, and the offset in its unit.

        Beside it stands what ``make recalibrate`` finds, as far as it has found something.
        """
        if not self.theta:
            return []
        scene = self.board.scene
        names = "name", "unit", "gain", "offset", "gain_found", "offset_found"
        parts = zip(
            scene.sensors, self._texts(self.theta), self._texts(self._found[1]), strict=True
        )
        return [
            dict(zip(names, (sensor, scene.units.get(sensor, ""), *own, *found), strict=True))
            for sensor, own, found in parts
        ]

    def _texts(self, theta: list[int]) -> list[tuple[str, str]]:
        """Gain in percent and offset of each sensor, as texts; empty ones without theta."""
        scene = self.board.scene
        if not theta:
            return [("", "")] * len(scene.sensors)
        gains, offsets = self._taught.corrections(np.array(theta))
        scales, places = scene.scales(scene.sensors), self.board.decimals
        return [
            (f"{100 * gain:+.2f}", f"{offset * scale.factor:+.{place}f}")
            for gain, offset, scale, place in zip(gains, offsets, scales, places, strict=False)
        ]

    def _warning(self) -> str:
        """Which sensors the board corrects by more than can be expected; empty for none."""
        sensors, most = self.board.scene.sensors, ONE * MOST_DRIFT
        far = [
            f"{name} ({abs(code) / ONE:.1f} times)"
            for name, code in zip([*sensors, *sensors], self.theta, strict=False)
            if abs(code) > most
        ]
        if not far:
            return ""
        return (
            "The board corrects these by much more than sensors are expected to drift: "
            f"{', '.join(dict.fromkeys(far))}. The placements tell too little of them, or are "
            "wrong. Show more placements, or use what make recalibrate finds."
        )

    def state(
        self, course: Iterable[tuple[float, list[float]]], now: float, learning: bool
    ) -> dict[str, Any]:
        """What the page shows of it.

        course: Times, and the outputs then; no outputs where the line was cut.
        """
        there = self._there
        places = self.board.decimals[len(self.board.scene.sensors) :]
        first = self.count - len(self._shown)
        return {
            "on": learning,
            "shown": self.count,
            "places": self.places,
            "tour": self.tour is not None,
            "there": there is not None,
            # Of the outputs at the placement that is there, each after its time.
            "errors": [
                [round(t - now, 3), *(v - k for v, k in zip(values, there, strict=False))]
                for t, values in course
                if there is not None and t >= self._since
            ],
            "theta": self.theta,
            "corrections": self._corrections(),
            "recalibrated": self._found[1],
            "warning": self._warning(),
            "placements": [
                {
                    "number": first + number,
                    "known": [f"{v:.{d}f}" for v, d in zip(known, places, strict=True)],
                    "errors": [f"{v:+.{d}f}" for v, d in zip(errors, places, strict=True)],
                }
                for number, (_, known, errors) in enumerate(self._shown, 1)
            ],
        }
