"""Two logarithmic axes for pictures whose bytes must not depend on a plotting library."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import floor, log10

from tactus.report.draw.drawing import FAINT, INK, Point, line, text

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
