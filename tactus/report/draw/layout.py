"""Arranges boxes in rows and columns. Each box is as large as its content.

A part is drawn from its upper left corner. The parts of a row are aligned at the points ``ay``
below their upper edges, so that an arrow between two parts meets both. ``ax`` does the same for the
parts of a column.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tactus.report.draw.drawing import (
    Point,
    arrow_head,
    box,
    group,
    line,
    text,
    text_width,
)

PAD, LINE, TITLE, SMALL = 8.0, 13.0, 11.5, 10.0


@dataclass(frozen=True)
class Part:
    """Something that can be placed: its size, where arrows meet it, and how it is drawn."""

    width: float
    height: float
    ax: float
    ay: float
    draw: Callable[[Point], list[str]]


def labelled(
    title: str, lines: Sequence[str] = (), content: Part | None = None, tip: str = ""
) -> Part:
    """A box with a title and lines of text, and possibly other parts inside.

    tip: The text that is shown when a pointer rests on the box.
    """
    # Bold letters are wider.
    words = max([1.15 * text_width(title, TITLE), *(text_width(words, SMALL) for words in lines)])
    inner = content.width if content else 0.0
    width = max(words, inner) + 2 * PAD
    head = PAD + LINE * (1 + len(lines))
    head += PAD / 2 if content else 0.0
    height = head + (content.height if content else 0.0) + PAD / 2
    indent = (width - inner) / 2

    def draw(at: Point) -> list[str]:
        x, y = at
        # A box may be wider than the page, so the title is at its left, where it is seen first.
        start, anchor = (x + PAD, "start") if content else (x + width / 2, "middle")
        body = [box(at, (width, height), rx=3, stroke_width=0.8 if content else 1.2)]
        body.append(text((start, y + 17), title, TITLE, font_weight="bold", text_anchor=anchor))
        for n, words in enumerate(lines, 1):
            body.append(text((start, y + 17 + LINE * n), words, SMALL, text_anchor=anchor))
        if content:
            body += content.draw((x + indent, y + head))
        return [group(body, tip)]

    if content:
        return Part(width, height, indent + content.ax, head + content.ay, draw)
    return Part(width, height, width / 2, height / 2, draw)


def arrow(lines: Sequence[str] = (), across: bool = True, length: float = 18.0) -> Part:
    """An arrow to the right or down, with a text beside it."""
    words = max([0.0, *(text_width(words, SMALL) for words in lines)])
    if not across:
        height = max(length, LINE * len(lines) + 6)

        def down(at: Point) -> list[str]:
            x, y = at[0] + words + 6, at[1]
            start = y + height / 2 - LINE * (len(lines) - 1) / 2 + 3.5
            body = [line([(x, y), (x, y + height - 3)]), arrow_head((x, y + height), (0, 1))]
            return body + [
                text((x + 6, start + LINE * n), given, SMALL) for n, given in enumerate(lines)
            ]

        return Part(2 * words + 12, height, words + 6, height / 2, down)
    width = max(length, words + 12)
    above = LINE * len(lines)

    def right(at: Point) -> list[str]:
        x, y = at[0], at[1] + above + 4
        body = [line([(x, y), (x + width - 3, y)]), arrow_head((x + width, y), (1, 0))]
        return body + [
            text((x + width / 2 - 2, at[1] + LINE * n + 9), given, SMALL, text_anchor="middle")
            for n, given in enumerate(lines)
        ]

    return Part(width, above + 8, width / 2, above + 4, right)


def row(parts: Sequence[Part], gap: float = 0.0, main: int | None = None) -> Part:
    """Parts side by side. Arrows from above meet the part with the index ``main``."""
    above = max(part.ay for part in parts)
    below = max(part.height - part.ay for part in parts)
    width = sum(part.width for part in parts) + gap * (len(parts) - 1)
    starts = [sum(part.width + gap for part in parts[:n]) for n in range(len(parts))]
    ax = width / 2 if main is None else starts[main] + parts[main].ax

    def draw(at: Point) -> list[str]:
        body = []
        for part, start in zip(parts, starts, strict=True):
            body += part.draw((at[0] + start, at[1] + above - part.ay))
        return body

    return Part(width, above + below, ax, above, draw)


def column(parts: Sequence[Part], gap: float = 0.0, main: int | None = None) -> Part:
    """Parts below each other. Arrows from the side meet the part with the index ``main``."""
    before = max(part.ax for part in parts)
    after = max(part.width - part.ax for part in parts)
    height = sum(part.height for part in parts) + gap * (len(parts) - 1)
    tops = [sum(part.height + gap for part in parts[:n]) for n in range(len(parts))]
    ay = height / 2 if main is None else tops[main] + parts[main].ay

    def draw(at: Point) -> list[str]:
        body = []
        for part, top in zip(parts, tops, strict=True):
            body += part.draw((at[0] + before - part.ax, at[1] + top))
        return body

    return Part(before + after, height, before, ay, draw)


def side_by_side(parts: Sequence[Part], gap: float = 14.0) -> Part:
    """Parallel parts below each other, which share the stream from above and the one below."""
    stack = column(parts, gap)
    margin = 22.0
    tops = [sum(part.height + gap for part in parts[:n]) for n in range(len(parts))]
    middle = margin + stack.ax

    def draw(at: Point) -> list[str]:
        x, y = at
        inner, right = y + 12, x + stack.width + 2 * margin
        body = stack.draw((x + margin, inner))
        ends = [inner + top + part.ay for top, part in zip(tops, parts, strict=True)]
        body.append(line([(x + middle, y), (x + 6, y), (x + 6, ends[-1])]))
        bottom = inner + stack.height + 12
        body.append(line([(right - 6, ends[0]), (right - 6, bottom), (x + middle, bottom)]))
        for part, end in zip(parts, ends, strict=True):
            edge = x + margin + stack.ax - part.ax
            body.append(line([(x + 6, end), (edge - 3, end)]))
            body.append(arrow_head((edge, end), (1, 0)))
            body.append(line([(edge + part.width, end), (right - 6, end)]))
        return body

    return Part(stack.width + 2 * margin, stack.height + 24, middle, 12 + stack.ay, draw)
