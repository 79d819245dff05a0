"""What wires hold during a run: known numbers, X, expressions over samples, and pieces of these
side by side.

A value is an int (all bits known), `X` (nothing known), an `Expression` (a word that hangs on
samples), or a tuple of pieces (source, low, count) from the lowest bit up. The words of a memory
are a list of values.
"""

from collections.abc import Iterable
from typing import Any


class Unknown:
    def __repr__(self) -> str:
        return "X"


X = Unknown()


class Expression:
    """The result of a cell, once for each different cell: equal expressions are one object."""

    __slots__ = ("arguments", "extra", "kind", "name", "result", "width")

    def __init__(self, kind: str, width: int, arguments: tuple[Any, ...], extra: Any, name: str):
        self.kind, self.width, self.extra, self.name = kind, width, extra, name
        self.arguments = arguments
        self.result: Any = None


class Words(list[Any]):
    """The words of a memory, which are never changed, so that an expression may name them."""

    __hash__ = object.__hash__  # type: ignore[assignment]


Bits = Any
Piece = tuple[Any, int, int]


def pieces(v: Bits, width: int) -> tuple[Piece, ...]:
    return v if isinstance(v, tuple) else ((v, 0, width),)


def join(parts: Iterable[Piece]) -> Bits:
    """The value whose pieces these are, as simple as it can be."""
    found: list[Piece] = []
    for source, low, count in parts:
        if isinstance(source, int):
            source, low = source >> low & (1 << count) - 1, 0
        if found and count:
            last, start, length = found[-1]
            if isinstance(source, int):
                if isinstance(last, int):
                    found[-1] = last | source << length, 0, length + count
                    continue
            elif last is source and (source is X or start + length == low):
                found[-1] = source, start, length + count
                continue
        if count:
            found.append((source, low, count))
    if len(found) == 1:
        source, low, count = found[0]
        if isinstance(source, int) or source is X or (low == 0 and count == source.width):
            return source
    return tuple(found)


def cut(v: Bits, low: int, count: int) -> tuple[Piece, ...]:
    """The pieces of `count` bits from bit `low` on."""
    if not isinstance(v, tuple):
        return ((v, low, count),)
    found = []
    for source, start, length in v:
        a, b = max(low, 0), min(low + count, length)
        if a < b:
            found.append((source, start + a, b - a))
        low -= length
    return tuple(found)


def part(v: Bits, low: int, count: int) -> Bits:
    return v >> low & (1 << count) - 1 if isinstance(v, int) else join(cut(v, low, count))


def unknown(v: Bits) -> bool:
    """Whether any bit is X."""
    return v is X or (isinstance(v, tuple) and any(p[0] is X for p in v))


def extended(v: Bits, width: int, to: int, signed: bool) -> Bits:
    """The value in `to` bits, filled by its sign or by 0."""
    if to <= width:
        return part(v, 0, to)
    top = cut(v, width - 1, 1) * (to - width) if signed else ((0, 0, to - width),)
    return join((*pieces(v, width), *top))


def abstract(v: Bits) -> Bits:
    """The value with X for all that hangs on samples."""
    if isinstance(v, Words):
        return Words(map(abstract, v))
    if isinstance(v, int):
        return v
    parts = pieces(v, getattr(v, "width", 1))
    return join((s if isinstance(s, int) else X, low, count) for s, low, count in parts)


def _bit_by_bit(v: Bits, width: int) -> list[Piece]:
    return [
        (s >> low + k & 1, 0, 1) if isinstance(s, int) else (s, 0 if s is X else low + k, 1)
        for s, low, count in pieces(v, width)
        for k in range(count)
    ]


def agreed(a: Bits, b: Bits, width: int) -> Bits:
    """What two values have in common, X elsewhere."""
    if a is b or a == b:
        return a
    if isinstance(a, Words):
        return Words(agreed(x, y, width) for x, y in zip(a, b, strict=True))
    pairs = zip(_bit_by_bit(a, width), _bit_by_bit(b, width), strict=True)
    return join(p if p == q else (X, 0, 1) for p, q in pairs)
