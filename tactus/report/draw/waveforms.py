"""Draws the values of the ports of a design, clock by clock, as a timing diagram."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from tactus.report.draw.svg import FAINT, INK, style, svg
from tactus.report.measure.simulated_frame import Row

# Lengths are CSS pixels. Those of a clock are enough for a value, or for one that stands upright.
WIDE, MIDDLE, NARROW, PAGE = 44.0, 20.0, 12.0, 1000.0
SLANT = 2.5
FLAG, UPRIGHT, LEVEL = 17.0, 42.0, 22.0
HEADING, SCALE = 22.0, 20.0
POINTS = 72 / 96
# A recording of more clocks would be wider than a screen can scroll with ease. Then a stretch in
# which all flags are low is drawn as so many clocks at either end and a gap.
MOST_CLOCKS, AT_AN_END = 300, 2
VALUE, NAME, OWNER = 9.0 * POINTS, 10.0 * POINTS, 11.0 * POINTS


def text_width(words: str, size: float) -> float:
    """The approximate width of ``words``, wide enough for the usual sans-serif fonts."""
    return 0.6 * size * len(words)


def waveforms(ports: Sequence[Row], title: str) -> str:
    """A timing diagram with a row for each port and a column for each clock.

    Clocks are counted from the first element of the frame. Flags are lines. Codes are written as
    real values in the clocks in which they count. In long recordings, clocks in which no flag is
    high are left out.

    ports: Ports with equally many clocks. Clock 0 is the first in which a flag is high.

    Returns: One ``<svg>`` element, wider than a phone.
    """
    zero = min(port.values.index(1) for port in ports if port.fmt is None and 1 in port.values)
    shown = _shown(ports)
    # In a gap every port keeps its value.
    taken = [clock if clock is not None else (shown[n - 1] or 0) for n, clock in enumerate(shown)]
    ports = [replace(port, values=tuple(port.values[k] for k in taken)) for port in ports]
    flags = {(port.owner, port.name): port.values for port in ports if port.fmt is None}
    count, names = len(shown), 8 + max(text_width(port.name, 10) for port in ports)
    pitch = WIDE if count * WIDE <= PAGE else MIDDLE if count * MIDDLE <= PAGE else NARROW
    tall = LEVEL if pitch == WIDE else UPRIGHT
    with style():
        figure = Figure()
        axes = figure.add_axes((0, 0, 1, 1))
        y, labels = 8.0, {}
        for owner, rows in groupby(ports, key=lambda port: port.owner):
            # Its background hides the lines of the clocks behind the letters.
            paper = {"facecolor": "white", "edgecolor": "none", "pad": 1}
            heading = axes.text((4 - names) / pitch, y + HEADING / 2, owner, bbox=paper)
            heading.set(fontsize=OWNER, fontweight="bold", va="center")
            y += HEADING
            for port in rows:
                height = FLAG if port.fmt is None else tall
                labels[y + height / 2] = port.name
                if port.fmt is None:
                    levels = [0.5 if value is None else value for value in port.values]
                    heights = y + 3 + (height - 5) * (1 - np.array(levels))
                    axes.stairs(heights, baseline=None, color=INK, linewidth=0.9)
                else:
                    _codes(axes, port, flags[port.owner, port.valid], y, height, pitch)
                y += height + 3
            y += 4
        axes.set_yticks(list(labels), list(labels.values()), fontsize=NAME)
        _number(axes, shown, zero, y - 4, pitch)
        axes.set(xlim=(0, count), ylim=(y, 0))
        axes.tick_params(length=0, labeltop=True, labelbottom=False)
        axes.spines[:].set_visible(False)
        axes.grid(visible=False)
        longest = min(PAGE, max(1.15 * text_width(port.owner, 11) for port in ports))
        whole = np.array([max(names + pitch * count, longest) + 8, SCALE + y])
        figure.set_size_inches(*(whole / 96))
        axes.set_position((names / whole[0], 0, pitch * count / whole[0], y / whole[1]))
        return svg(figure, "waveforms", title, narrowest=whole[0])


def _shown(ports: Sequence[Row]) -> list[int | None]:
    """The clocks that are drawn, and None for a gap in which no flag is high."""
    flags = [port.values for port in ports if port.fmt is None]
    count = len(flags[0])
    if count <= MOST_CLOCKS:
        return list(range(count))
    found: list[int | None] = []
    for idle, clocks in groupby(range(count), key=lambda k: all(one[k] == 0 for one in flags)):
        run = list(clocks)
        if idle and len(run) > 2 * AT_AN_END + 1:
            found += [*run[:AT_AN_END], None, *run[-AT_AN_END:]]
        else:
            found += run
    return found


def _number(
    axes: Axes, shown: Sequence[int | None], zero: int, bottom: float, pitch: float
) -> None:
    """A line with its number at every fifth clock, or at every clock if there is room.

    A gap is between two dark lines, and the first clock behind it has its number.
    """
    behind = {column + 1 for column, clock in enumerate(shown) if clock is None}
    # Where clocks are left out, numbers have up to four digits.
    every = 1 if pitch == WIDE or (pitch == MIDDLE and not behind) else 5
    numbered = {
        column: clock - zero
        for column, clock in enumerate(shown)
        if clock is not None
        and (
            column in behind
            or ((clock - zero) % every == 0 and not behind & {column + n for n in (-2, -1, 1, 2)})
        )
    }
    middles = [column + 0.5 for column in numbered]
    axes.set_xticks(middles, list(map(str, numbered.values())), fontsize=VALUE)
    axes.vlines(list(numbered), 0, bottom, color=FAINT, linewidth=0.3)
    edges = [edge for column in behind for edge in (column - 1, column)]
    axes.vlines(edges, 0, bottom, color=INK, linewidth=0.6)
    axes.annotate("clock", (0, 1), (-3, 4), "axes fraction", "offset points", ha="right", size=NAME)


def _codes(
    axes: Axes, port: Row, counts: Sequence[int | None], y: float, height: float, pitch: float
) -> None:
    """A hexagon with the value in each clock that counts, and a line in the others."""
    top, middle, bottom, slant = y + 1, y + height / 2, y + height - 1, SLANT / pitch
    idle = np.where([flag == 1 for flag in counts], np.nan, middle)
    axes.stairs(idle, baseline=None, color=FAINT, linewidth=0.6)
    hexagons = []
    for k, (flag, code) in enumerate(zip(counts, port.values, strict=True)):
        if flag == 1:
            left, right = k + slant, k + 1 - slant
            upper, lower = [(left, top), (right, top)], [(right, bottom), (left, bottom)]
            hexagons.append([(k, middle), *upper, (k + 1, middle), *lower])
            words = (
                f"{port.fmt.to_real(code):.4f}" if port.fmt and code is not None else "undefined"
            )
            text = axes.text(k + 0.5, middle, words, fontsize=VALUE, ha="center", va="center")
            text.set_rotation(0 if pitch == WIDE else 90)
    axes.add_collection(PolyCollection(hexagons, facecolor="none", edgecolor=INK, linewidth=0.6))
