"""Points with their names on two logarithmic axes, the front among them, and what is beaten."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from math import floor, log10

from tactus.report.draw.drawing import ACCENT, FAINT, INK, Point, dot, line, text, text_width

# Wider than a digit of a number at an axis.
CHARACTER = 7.0


@dataclass(frozen=True)
class Axes:
    """A frame with the ranges of both axes.

    left, top, width, height: The place and size of the frame in the picture.
    across, up: The lowest and the highest value of each axis. All are above 0.
    """

    left: float
    top: float
    width: float
    height: float
    across: tuple[float, float]
    up: tuple[float, float]

    def at(self, x: float, y: float) -> Point:
        """The place of a pair of values."""
        return (
            self.left + self.width * _part(x, self.across),
            self.top + self.height * (1 - _part(y, self.up)),
        )

    def drawn(self, across: str, up: str) -> Iterator[str]:
        """Grid lines with their numbers, and the labels of the axes; ``up`` is above the frame."""
        bottom = self.top + self.height
        for value in _steps(self.across):
            x, _ = self.at(value, self.up[0])
            yield line([(x, self.top), (x, bottom)], stroke=FAINT, stroke_width=0.4)
            label = f"{value:g}"
            # Numbers next to each other are at least this far apart.
            room = self.width * _part(self.across[0] * 2, self.across)
            if label[0] == "1" or room >= CHARACTER * (len(label) + 1):
                yield text((x, bottom + 14), label, text_anchor="middle")
        for value in _steps(self.up):
            _, y = self.at(self.across[0], value)
            end = self.left + self.width
            yield line([(self.left, y), (end, y)], stroke=FAINT, stroke_width=0.4)
            yield text((self.left - 5, y + 4), f"{value:g}", text_anchor="end")
        corner = [(self.left, self.top), (self.left, bottom), (self.left + self.width, bottom)]
        yield line(corner, stroke=INK)
        yield text((self.left + self.width / 2, bottom + 30), across, text_anchor="middle")
        yield text((6, self.top - 14), up)


def _part(value: float, ends: tuple[float, float]) -> float:
    low, high = ends
    return log10(value / low) / log10(high / low)


def _steps(ends: tuple[float, float]) -> Iterator[float]:
    """The values 1, 2 and 5 of every decade between the ends."""
    for decade in range(floor(log10(ends[0])), floor(log10(ends[1])) + 1):
        for digit in (1, 2, 5):
            value = float(f"{digit}e{decade}")
            if ends[0] <= value <= ends[1]:
                yield value


RADIUS, SIZE = 4.0, 10.0
# How far a name may stand from its point. From the second distance on, a line joins the two.
DISTANCES = (8.0, 20.0, 34.0, 50.0, 68.0, 90.0)
WAYS = [(1, 0), (-1, 0), (1, -1), (1, 1), (-1, -1), (-1, 1), (0, -1), (0, 1)]

# Left, top, right and bottom.
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Named:
    """A point: less is better on both axes."""

    name: str
    x: float
    y: float

    def beaten_by(self, other: Named) -> bool:
        """Whether the other is at least as good on both axes, and better on one."""
        return other.x <= self.x and other.y <= self.y and (other.x, other.y) != (self.x, self.y)


def front(points: Sequence[Named]) -> list[Named]:
    """The points that no other one beats, from left to right."""
    found = [one for one in points if not any(map(one.beaten_by, points))]
    return sorted(found, key=lambda one: (one.x, one.name))


def drawn(points: Sequence[Named], axes: Axes) -> Iterator[str]:
    """The line of the front, a dot for each point, and its name: grey for those that are beaten."""
    best = front(points)
    steps: list[Point] = []
    for one in best:
        place = axes.at(one.x, one.y)
        # Between two points of the front, the upper one is the best there is.
        steps += [(place[0], steps[-1][1]), place] if steps else [place]
    if len(steps) > 1:
        yield line(steps, stroke=ACCENT, stroke_width=0.8)
    # The front has the first choice of places.
    ordered = [*best, *(one for one in points if one not in best)]
    places = [axes.at(one.x, one.y) for one in ordered]
    taken: list[Box] = [_around(place) for place in places]
    taken += [(a[0] - 1, a[1] - 1, b[0] + 1, b[1] + 1) for a, b in pairwise(steps)]
    for one, place in zip(ordered, places, strict=True):
        colour = ACCENT if one in best else FAINT
        box, anchor, apart = _free(one.name, place, axes, taken)
        taken.append(box)
        if apart:
            end = box[0] if anchor == "start" else box[2]
            middle = (box[0] + box[2]) / 2 if anchor == "middle" else end
            yield line([place, (middle, (box[1] + box[3]) / 2)], stroke=FAINT, stroke_width=0.5)
        yield dot(place, RADIUS, fill=colour)
        x = {"start": box[0], "end": box[2], "middle": (box[0] + box[2]) / 2}[anchor]
        ink = {"fill": colour, "text_anchor": anchor}
        yield text((x, box[3] - 3), one.name, SIZE, **ink)


def _around(place: Point) -> Box:
    x, y = place
    return x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS


def _free(name: str, place: Point, axes: Axes, taken: Sequence[Box]) -> tuple[Box, str, bool]:
    """The nearest box that covers nothing, how its text is anchored, and whether a line is due."""
    width, height = text_width(name, SIZE), SIZE + 2
    x, y = place
    options: list[tuple[Box, str, bool]] = []
    for distance, (dx, dy) in product(DISTANCES, WAYS):
        anchor = {1: "start", -1: "end", 0: "middle"}[dx]
        left = x + dx * distance - {"start": 0, "end": width, "middle": width / 2}[anchor]
        top = y + dy * distance - height / 2
        box = left, top, left + width, top + height
        options.append((box, anchor, distance > DISTANCES[0]))
    return min(options, key=lambda option: _cost(option[0], axes, taken))


def _cost(box: Box, axes: Axes, taken: Sequence[Box]) -> float:
    """The area that a box shares with others or has outside the frame; the first of equals wins."""
    left, top, right, bottom = box
    frame = (axes.left, axes.top, axes.left + axes.width, axes.top + axes.height)
    whole = (right - left) * (bottom - top)
    return whole - _shared(box, frame) + sum(_shared(box, other) for other in taken)


def _shared(one: Box, other: Box) -> float:
    wide = min(one[2], other[2]) - max(one[0], other[0])
    high = min(one[3], other[3]) - max(one[1], other[1])
    return max(wide, 0) * max(high, 0)
