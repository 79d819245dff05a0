"""Draws the values of the ports of a design, clock by clock, as a timing diagram."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

from tactus.report.draw.drawing import (
    FAINT,
    INK,
    Point,
    group,
    line,
    number,
    picture,
    text,
    text_width,
)
from tactus.report.measure.simulated_frame import Row

# The pixels of a clock, enough for a value, or for a value that is written upright.
WIDE, MIDDLE, NARROW, PAGE = 44.0, 20.0, 12.0, 1000.0
SLANT = 2.5
FLAG, UPRIGHT, LEVEL = 17.0, 42.0, 22.0
HEADING, SCALE = 22.0, 20.0
# A recording of more clocks would be wider than a screen can scroll with ease. Then a stretch in
# which all flags are low is drawn as so many clocks at either end and a gap.
MOST_CLOCKS, AT_AN_END = 300, 2
VALUE = 9.0
# This background hides the lines of the clocks behind the letters.
_EDGE: dict[str, str | float] = {"stroke": "#fff", "stroke_width": 4.0, "paint_order": "stroke"}


def waveforms(ports: Sequence[Row], title: str) -> str:
    """A timing diagram with a row for each port and a column for each clock.

    Clocks are counted from the first element of the frame. Flags are lines. Codes are written as
    real values in the clocks in which they count. In long recordings, clocks in which no flag is
    high are left out.

    ports: Ports with equally many clocks. Clock 0 is the first in which a flag is high.

    Returns: One ``<svg>`` element, wider than a phone.
    """
    clocks = {len(port.values) for port in ports}
    if len(clocks) != 1:
        raise ValueError(
            f"waveforms: got ports of {sorted(clocks)} clocks, expected one number of clocks"
        )
    zero = min(port.values.index(1) for port in ports if port.fmt is None and 1 in port.values)
    shown = _shown(ports)
    # In a gap every port keeps its value.
    taken = [clock if clock is not None else (shown[n - 1] or 0) for n, clock in enumerate(shown)]
    ports = [replace(port, values=tuple(port.values[k] for k in taken)) for port in ports]
    count = len(shown)
    flags = {(port.owner, port.name): port.values for port in ports if port.fmt is None}
    names = 8 + max(text_width(port.name, 10) for port in ports)
    pitch = WIDE if count * WIDE <= PAGE else MIDDLE if count * MIDDLE <= PAGE else NARROW
    tall = LEVEL if pitch == WIDE else UPRIGHT
    body, y = [], SCALE + 8
    for owner, rows in groupby(ports, key=lambda port: port.owner):
        body.append(text((4, y + 13), owner, 11, font_weight="bold", **_EDGE))
        y += HEADING
        for port in rows:
            height = FLAG if port.fmt is None else tall
            body.append(text((names - 4, y + height / 2 + 3), port.name, 10, text_anchor="end"))
            if port.fmt is None:
                drawn = [_flag(port.values, (names, y), pitch)]
            else:
                if (port.owner, port.valid) not in flags:
                    raise ValueError(
                        f"waveforms: {port.owner}.{port.name}: got valid={port.valid!r}, expected "
                        "a flag of the same owner"
                    )
                counts = flags[port.owner, port.valid]
                drawn = _codes(port, counts, (names, y), pitch, tall)
            body.append(group(drawn, data_port=f"{port.owner}.{port.name}"))
            y += height + 3
        y += 4
    width = names + pitch * count + 8
    grid = _grid(shown, zero, (names, SCALE), y - 4, pitch)
    return picture(title, (width, y), [*grid, *body], width, width * 1.1)


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


def _grid(
    shown: Sequence[int | None], zero: int, at: Point, bottom: float, pitch: float
) -> list[str]:
    """A line with its number at every fifth clock, or at every clock if there is room.

    A gap is between two dark lines, and the first clock behind it has its number.
    """
    x, y = at
    body = [text((x - 4, y - 4), "clock", 10, text_anchor="end")]
    behind = {column + 1 for column, clock in enumerate(shown) if clock is None}
    # Where clocks are left out, numbers have up to four digits.
    every = 1 if pitch == WIDE or (pitch == MIDDLE and not behind) else 5
    for column, clock in enumerate(shown):
        left = x + pitch * column
        if clock is None:
            for edge in (left, left + pitch):
                body.append(line([(edge, y), (edge, bottom)], stroke=INK, stroke_width=0.8))
            continue
        near = behind & {column - 2, column - 1, column + 1, column + 2}
        if column in behind or ((clock - zero) % every == 0 and not near):
            body.append(line([(left, y), (left, bottom)], stroke=FAINT, stroke_width=0.4))
            label = str(clock - zero)
            body.append(text((left + pitch / 2, y - 4), label, VALUE, text_anchor="middle"))
    return body


def _flag(values: Sequence[int | None], at: Point, pitch: float) -> str:
    """A line that is high or low, or between the two while the flag is undefined."""
    x, y = at
    level = {0: y + FLAG - 2, 1: y + 3, None: y + FLAG / 2}
    points = []
    for clock, value in enumerate(values):
        points += [(x + pitch * clock, level[value]), (x + pitch * (clock + 1), level[value])]
    kept = [
        point
        for n, point in enumerate(points)
        if not 0 < n < len(points) - 1 or not points[n - 1][1] == point[1] == points[n + 1][1]
    ]
    return line(kept, stroke_width=1.2)


def _codes(
    port: Row, counts: Sequence[int | None], at: Point, pitch: float, height: float
) -> list[str]:
    """A hexagon with the value in each clock that counts, and a line in the others."""
    x, y = at
    top, middle, bottom = y + 1, y + height / 2, y + height - 1
    body = []
    for high, clocks in groupby(range(len(counts)), key=lambda clock: counts[clock] == 1):
        run = list(clocks)
        if not high:
            ends = [(x + pitch * run[0], middle), (x + pitch * (run[-1] + 1), middle)]
            body.append(line(ends, stroke=FAINT, stroke_width=0.8))
            continue
        for clock in run:
            a, b = x + pitch * clock, x + pitch * (clock + 1)
            corners = [
                (a, middle),
                (a + SLANT, top),
                (b - SLANT, top),
                (b, middle),
                (b - SLANT, bottom),
                (a + SLANT, bottom),
                (a, middle),
            ]
            body.append(line(corners, stroke_width=0.8))
            body.append(_value(port, port.values[clock], ((a + b) / 2, middle), pitch))
    return body


def _value(port: Row, code: int | None, at: Point, pitch: float) -> str:
    words = "undefined" if code is None or port.fmt is None else f"{port.fmt.to_real(code):.4f}"
    x, y = at
    if pitch == WIDE:
        return text((x, y + 3), words, VALUE, text_anchor="middle")
    turned = f"rotate(-90 {number(x)} {number(y)})"
    return text((x, y + 3), words, VALUE, text_anchor="middle", transform=turned, fill=INK)
