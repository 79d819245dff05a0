"""Points with their names on two logarithmic axes: the front, and in grey what it beats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, StrMethodFormatter

from golden.numbers.real import Real
from tactus.report.draw.svg import ACCENT, FAINT, style, svg

# At so many dots per inch, a pixel is a point.
INCHES, DPI, RADIUS, SIZE = (7.4, 4.9), 72, 3.0, 9.0
# Where a name may stand: beside its dot, or so far from it that a line joins the two, which runs
# through other dots if it is level or upright.
NEAR, FAR = 8, (17, 28, 40, 54, 72)
SIDES = [(1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (0, -1)]
WAYS = [*product([NEAR], SIDES), *product(FAR, SIDES[2:6])]
PLACES = np.array([(far * dx, far * dy, dx) for far, (dx, dy) in WAYS])
ANCHORS = {1: "left", 0: "center", -1: "right"}


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


def drawn(
    points: Sequence[Named], name: str, title: str, across: str, up: str, sentence: str
) -> str:
    """The line of the front, a dot for each point, and its name: grey for those that are beaten.

    name: See ``tactus.report.draw.svg.svg``.
    sentence: Says what the picture shows, for readers who do not see it. All figures follow it.
    """
    best = front(points)
    # Between two points of the front, the upper one is the best there is.
    steps = [at for a, b in pairwise(best) for at in ((a.x, a.y), (b.x, a.y), (b.x, b.y))]
    # The front has the first choice of places.
    ordered = [*best, *(one for one in points if one not in best)]
    colours = [ACCENT if one in best else FAINT for one in ordered]
    with style():
        figure = Figure(INCHES, DPI, layout="constrained")
        axes = figure.add_subplot(xscale="log", yscale="log", xlabel=across, ylabel=up)
        axes.set_title(title, loc="left", fontsize="medium", fontweight="bold")
        axes.margins(0.07, 0.1)
        axes.plot(*zip(*steps, strict=True), color=ACCENT, linewidth=0.8) if steps else None
        at = np.array([(one.x, one.y) for one in ordered]).reshape(-1, 2)
        axes.scatter(at[:, 0], at[:, 1], s=(2 * RADIUS) ** 2, c=colours, zorder=3)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.minorticks_off()
        # There is room for names at the right.
        axes.set_xlim(right=4 * axes.get_xlim()[1])
        # Names must not move the axes on which their places are chosen.
        figure.draw_without_rendering()
        axes.autoscale(False)
        figure.set_layout_engine("none")
        _write(axes, [one.name for one in ordered], colours, at, np.array(steps))
        figures = "; ".join(f"{one.name}: {one.x:g}, {round(one.y, 2):g}" for one in ordered)
        said = f"{title}. {sentence} By {across}, and by {up}: {figures}."
        return svg(figure, name, said, narrowest=560)


def _write(axes: Axes, names: Sequence[str], colours: Sequence[str], at: Real, steps: Real) -> None:
    """Write each name at the nearest place where it covers nothing, or else the least."""
    dots = axes.transData.transform(at)
    taken = np.hstack([dots - RADIUS, dots + RADIUS])
    if len(steps):
        ends = axes.transData.transform(steps)
        low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])
        taken = np.vstack([taken, np.hstack([low - 1, high + 1])])
    frame = np.array([axes.bbox.extents])
    for name, colour, xy, dot in zip(names, colours, at, dots, strict=True):
        text = axes.annotate(name, xy, fontsize=SIZE, color=colour, va="center")
        size = np.array(text.get_window_extent().size)
        # Left of a dot ends what stands there, and above or below it the middle is.
        corners = dot + PLACES[:, :2] + (PLACES[:, 2:] - 1) / 2 * size * (1, 0) - size * (0, 0.5)
        boxes = np.hstack([corners, corners + size])
        outside = size.prod() - _shared(boxes, frame)[:, 0]
        # Last bits choose no place.
        n = int(np.argmin(np.round(outside + _shared(boxes, taken).sum(axis=1), 3)))
        taken = np.vstack([taken, boxes[n]])
        dx, dy, side = PLACES[n]
        text.set(position=(dx, dy), anncoords="offset points", ha=ANCHORS[side])
        if n >= len(SIDES):
            ends = np.array([dot, dot + PLACES[n, :2]])
            axes.plot(*axes.transData.inverted().transform(ends).T, color=FAINT, linewidth=0.5)


def _shared(boxes: Real, others: Real) -> Real:
    """The area that each of the boxes shares with each of the others.

    boxes, others: shape (n, 4), the left, lower, right and upper side of each.
    """
    first, second = boxes[:, np.newaxis], others[np.newaxis]
    sides = np.minimum(first[..., 2:], second[..., 2:]) - np.maximum(
        first[..., :2], second[..., :2]
    )
    shared: Real = np.clip(sides, 0, None).prod(axis=2)
    return shared
