"""An animation of a load that moves along the beam, with sensor readings and drawn profile."""

from collections.abc import Sequence

import numpy as np

from golden.numbers.real import Real
from tactus.report.draw.drawing import (
    ACCENT,
    FAINT,
    INK,
    Point,
    dot,
    group,
    identifier,
    line,
    number,
    picture,
    text,
)
from tactus.report.draw.load import FRAME, Beam, beam
from tactus.scene import Scene

# How many seconds each position is shown.
STEP = 0.6
WIDTH, HEIGHT = 360.0, 316.0


LEFT, RIGHT, TOP, BOTTOM = 38.0, 350.0, 42.0, 190.0
# Where the bars start, and how long a bar of 1 is.
ZERO, REACH = 262.0, 26.0
TICK_MM, TICK_LOAD = 20, 0.2


def animation(scene: Scene, frame: int = FRAME) -> str:
    """The load of a recorded frame at every position at which it was recorded, one after the other.

    Each step is a recorded frame, without interpolation between them. The animation needs no
    script: a style sheet moves it.

    scene: A scene with load, position, width and shape among its outputs.
    frame: Row of the recorded vectors. All rows with the same load, width and shape are shown.

    Returns: One ``<svg>`` element.
    """
    known = beam(scene)
    known.check(frame, scene.path)
    others = [0, 2, 3]
    same = (known.targets[:, others] == known.targets[frame, others]).all(axis=1)
    rows = np.flatnonzero(same)
    places = [int(row) for row in rows[np.argsort(known.targets[rows, 1], kind="stable")]]
    drawing = _Drawing(known, places)
    moving = steps("animation", scene.name, STEP, [drawing.step(place) for place in places])
    body = [*drawing.axes(scene.sensors), *moving]
    title = f"A recorded load at {len(places)} positions along the beam, scene {scene.name}"
    return picture(title, (WIDTH, HEIGHT), body)


class _Drawing:
    """Axes that have room for every step, and the steps in them."""

    def __init__(self, known: Beam, steps: Sequence[int]):
        self.known = known
        corners = [known.true(step) for step in steps]
        heights = np.concatenate([*(h for _, h in corners), *(known.drawn(step) for step in steps)])
        places = np.concatenate([known.positions, *(at for at, _ in corners)])
        self.span = float(places.min()), float(places.max())
        self.high = float(heights.max()) * 1.05
        self.low = min(0.0, float(heights.min()))

    def at(self, millimetres: float, load: float) -> Point:
        """The place of a point of the beam in the picture."""
        first, last = self.span
        return (
            LEFT + (RIGHT - LEFT) * (millimetres - first) / (last - first),
            BOTTOM - (BOTTOM - TOP) * (load - self.low) / (self.high - self.low),
        )

    def axes(self, sensors: Sequence[str]) -> list[str]:
        """Everything that does not move."""
        first, last = self.span
        body = [
            line([(LEFT, 10), (LEFT + 18, 10)], stroke=ACCENT),
            text((LEFT + 22, 14), "recorded load"),
            line([(LEFT + 118, 10), (LEFT + 136, 10)], stroke_width=1.6),
            dot((LEFT + 127, 10), 2.4),
            text((LEFT + 140, 14), "profile, bit-true"),
        ]
        for n in range(int(np.ceil(first / TICK_MM)), int(last // TICK_MM) + 1):
            x = self.at(TICK_MM * n, 0)[0]
            body.append(line([(x, TOP), (x, BOTTOM)], stroke=FAINT, stroke_width=0.3))
            body.append(text((x, BOTTOM + 13), str(TICK_MM * n), 10, text_anchor="middle"))
        for n in range(int(np.ceil(self.low / TICK_LOAD)), int(self.high // TICK_LOAD) + 1):
            y = self.at(0, TICK_LOAD * n)[1]
            body.append(line([(LEFT, y), (RIGHT, y)], stroke=FAINT, stroke_width=0.3))
            body.append(text((LEFT - 4, y + 3.5), f"{TICK_LOAD * n:.1f}", 10, text_anchor="end"))
        body.append(text((LEFT - 34, TOP - 8), "load, coded", 10))
        middle = (LEFT + RIGHT) / 2
        body.append(text((middle, BOTTOM + 27), "position, mm", 10, text_anchor="middle"))
        body.append(line([(LEFT, ZERO), (RIGHT, ZERO)], stroke=FAINT, stroke_width=0.6))
        body.append(text((LEFT - 4, ZERO + 3.5), "0", 10, text_anchor="end"))
        for name, x in zip(sensors, _columns(len(sensors)), strict=True):
            body.append(text((x, HEIGHT - 6), name, 10, text_anchor="middle"))
        return body

    def step(self, frame: int) -> list[str]:
        """The drawing of one recorded frame."""
        known = self.known
        first, last = self.span
        places, heights = known.true(frame)
        true = [(first, 0.0), *zip(places, heights, strict=True), (last, 0.0)]
        drawn = [
            self.at(x, load) for x, load in zip(known.positions, known.drawn(frame), strict=True)
        ]
        truth = known.mm * known.targets[frame, 1]
        found = known.mm * known.profile.fmt.to_real(known.frames[frame, 1])
        words = f"at {truth:.1f} mm, found at {found:.1f} mm"
        return [
            line([self.at(x, load) for x, load in true], stroke=ACCENT),
            line(drawn, stroke_width=1.6),
            *(dot(point, 2.4) for point in drawn),
            text((RIGHT, TOP - 8), words, text_anchor="end"),
            *_bars(known.sensors[frame]),
        ]


def _columns(count: int) -> list[float]:
    pitch = (RIGHT - LEFT) / count
    return [LEFT + pitch * (n + 0.5) for n in range(count)]


def _bars(readings: Real) -> list[str]:
    """A bar for each sensor, up or down, with the reading."""
    body = []
    for reading, x in zip(readings, _columns(len(readings)), strict=True):
        end = ZERO - REACH * reading
        body.append(line([(x, ZERO), (x, end)], stroke=INK, stroke_width=7.0))
        beyond = end + 11 if reading < 0 else end - 4
        body.append(text((x, beyond), f"{reading:.2f}", 10, text_anchor="middle"))
    return body


# Paper, and readers who ask for less motion, get only the step in the middle.
_STYLE = """\
.{name}-step{{visibility:hidden;animation:{name}-show {total}s step-end infinite}}
.{name}-still{{visibility:visible}}
@keyframes {name}-show{{0%{{visibility:visible}}{end}%,100%{{visibility:hidden}}}}
@media (prefers-reduced-motion:reduce){{.{name}-step{{animation:none}}}}
@media print{{.{name}-step{{animation:none}}}}
"""


def steps(kind: str, scene: str, seconds: float, bodies: Sequence[list[str]]) -> list[str]:
    """Elements that show one step at a time, again and again.

    kind, scene: Those of the picture; see ``identifier``.
    seconds: How long each step is shown.
    bodies: The elements of each step.
    """
    total, name = seconds * len(bodies), identifier(kind, scene)
    style = _STYLE.format(name=name, total=number(total), end=number(100 / len(bodies)))
    body = ["<style>", style, "</style>"]
    for n, step in enumerate(bodies):
        still = f" {name}-still" if n == len(bodies) // 2 else ""
        # Each step starts in the past, so that all run at once, each at its own point of the cycle.
        delay = f"animation-delay:{number(seconds * n - total)}s"
        body.append(group(step, class_=f"{name}-step{still}", style=delay))
    return body
