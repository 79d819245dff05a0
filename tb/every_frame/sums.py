"""What a word of hardware holds, taken over all frames at once: a sum of functions of one word
each.

A `Sum` is a constant and, for each of some words, a function of that word alone, given by its value
at every code that the word can take. It is an exact integer for every frame. A word is a sample, or
the floor of a sum over a power of two that was met on the way. Two rules make new sums of old ones:

- what is linear (sum, difference, product with a constant) works term by term;
- any function of one word works code by code, and a sum of several words becomes one word first.
"""

import itertools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

# The most codes of a word whose functions are written out code by code.
LONGEST = 1 << 24
MOST = 1 << 62
# The most bits that a floor drops of a sum of which it is a floor of a floor.
MOST_DROPPED = 50
# A straight line at the end of a function is written as one if it has so many codes.
LEAST_LINE = 64
# A word of fewer codes may be written out code by code on a finer grid.
FEW = 4096
# Of so many sums it is tried whether one is the floor of another.
MOST_PAIRED = 12
_numbers = itertools.count(1)


class UnsupportedError(Exception):
    """What the method cannot decide. It is never taken for a proof, and never for a difference."""


class Word:
    """A number that takes the codes low to high: sample number `name`, or floor((base + offset) /
    2^shift)."""

    def __init__(
        self,
        number: int,
        name: str,
        low: int,
        high: int,
        base: "Base | None" = None,
        offset: int = 0,
        shift: int = 0,
    ):
        self.number, self.name, self.low, self.high = number, name, low, high
        self.base, self.offset, self.shift = base, offset, shift
        self._flat: Curve | None = None
        self._start = 0

    @property
    def root(self) -> "Word | None":
        """The sample on which alone it depends, where it is a floor of a function of one sample."""
        if self.base is None or len(self.base.total.terms) > 1:
            return None
        (inner,) = self.base.total.terms
        return inner if inner.base is None else None

    @property
    def moves(self) -> bool:
        """Whether it is a floor of a sum that is the floor of another, in numbers that fit."""
        return bool(
            self.base and self.base.parent and self.shift + self.base.parent[1] < MOST_DROPPED
        )

    def flat(self) -> tuple["Curve | None", int]:
        """It as a function of its root, less its lowest code."""
        root = self.root
        assert root
        assert self.base
        if self._flat is None:
            (term,) = self.base.total.terms.values()
            values = (
                term.at(root.low, root.high) + self.base.total.constant + self.offset >> self.shift
            ) - self.low
            self._flat, self._start = curve(root, root.low, values, 0, 0)
        return self._flat, self._start


class Base:
    """A sum of several words, without a constant, of which words are floors."""

    def __init__(self, total: "Sum"):
        self.total = total
        self.words: dict[tuple[int, int], Word] = {}
        # sign * this = floor((parent + offset) / 2^shift), once that is known.
        self.parent: tuple[Base, int, int, int] | None = None
        self.seen = 0

    def above(self) -> "list[Base]":
        """This sum, and those of which it is a floor."""
        return [self, *(self.parent[0].above() if self.parent else [])]

    def uses(self, other: "Base") -> bool:
        """Whether words of the other sum are in this one, or in those that it is made of."""
        made = [w.base for w in self.total.terms if w.base]
        return any(b is other or b.uses(other) for b in made)

    def word(self, offset: int, shift: int) -> Word:
        """floor((sum + offset) / 2^shift), for an offset from 0 to 2^shift - 1."""
        _fits(offset)
        key = offset, shift
        if key not in self.words:
            low, high = ends(self.total)
            number = next(_numbers)
            self.words[key] = Word(
                number,
                f"word {number}",
                low + offset >> shift,
                high + offset >> shift,
                self,
                offset,
                shift,
            )
        return self.words[key]


class Curve:
    """A function of one word: values at the codes from `first` on, straight lines of the given
    slopes outside.

    It is 0 at the lowest code, and as short as it can be, so that equal functions have equal parts.
    """

    __slots__ = ("_ends", "first", "left", "right", "values", "word")

    def __init__(self, word: Word, first: int, values: np.ndarray, left: int, right: int):
        self.word, self.first, self.values, self.left, self.right = word, first, values, left, right
        self._ends: tuple[int, int] | None = None

    @property
    def last(self) -> int:
        return self.first + len(self.values) - 1

    @property
    def line(self) -> bool:
        """Whether it is one straight line, then of slope `right`."""
        return len(self.values) == 1 and self.left == self.right

    def at(self, low: int, high: int) -> np.ndarray:
        """The values at the codes low to high."""
        a, b = max(low, self.first), min(high, self.last)
        if a == low and b == high:
            return self.values[a - self.first : b - self.first + 1]
        result = np.empty(high - low + 1, dtype=np.int64)
        left, right = (
            max(0, min(self.first, high + 1) - low),
            max(0, high - max(self.last, low - 1)),
        )
        if left:
            result[:left] = int(self.values[0]) + self.left * (
                np.arange(low, low + left) - self.first
            )
        if b >= a:
            result[a - low : b - low + 1] = self.values[a - self.first : b - self.first + 1]
        if right:
            result[len(result) - right :] = int(self.values[-1]) + self.right * (
                np.arange(high - right + 1, high + 1) - self.last
            )
        return result

    @property
    def ends(self) -> tuple[int, int]:
        """The least and the greatest value."""
        if self._ends is None:
            ends = [int(self.values.min()), int(self.values.max())]
            ends += [
                int(self.values[0]) - self.left * (self.first - self.word.low),
                int(self.values[-1]) + self.right * (self.word.high - self.last),
            ]
            self._ends = min(ends), max(ends)
        return self._ends

    def times(self, factor: int) -> "Curve":
        if factor == 1:
            return self
        _fits(*(end * factor for end in self.ends))
        return Curve(
            self.word, self.first, self.values * factor, self.left * factor, self.right * factor
        )

    def bits(self) -> int:
        """A number whose lowest set bit is the greatest power of two that divides every
        difference."""
        return (
            int(np.bitwise_or.reduce(self.values - self.values[0]))
            | self.left
            | self.right
            | int(self.values[0])
        )

    def same(self, other: "Curve") -> bool:
        return self is other or (
            self.word is other.word
            and (self.first, self.left, self.right) == (other.first, other.left, other.right)
            and np.array_equal(self.values, other.values)
        )


def _common(words: Iterable[Word]) -> Word:
    """The coarsest grid of which the grids of all these words of one sum are parts."""
    words = list(words)
    first = words[0]
    if all(w is first for w in words):
        return first
    assert first.base is not None
    shift = min(w.shift for w in words)
    for w in words[1:]:
        if (w.offset - first.offset) % (1 << shift):
            shift = _twos(w.offset - first.offset)
    return first.base.word(first.offset % (1 << shift), shift)


def _finer(a: Curve, b: Curve) -> Word | None:
    """The grid onto which two functions of one sum are put together, if no straight line becomes a
    staircase."""
    word = _common((a.word, b.word))
    coarse = [c for c in (a, b) if c.word.shift > word.shift and (c.left or c.right)]
    if not coarse:
        return word
    low, high = Function(word, 0, coarse).window()
    short = all(c.word.high - c.word.low < FEW for c in coarse) and high - low < LONGEST >> 4
    return word if short and not all(c.line for c in (a, b)) else None


def _refined(c: Curve, word: Word) -> tuple[Curve | None, int]:
    """The function on a finer grid."""
    if c.word is word:
        return c, 0
    f = Function(word, 0, [c])
    low, high = f.window()
    c = f.terms[0]
    low, high = max(low - 1, word.low), min(high + 1, word.high)
    if high - low >= LONGEST:
        raise UnsupportedError(f"a function of a word that takes {high - low} values")
    return curve(
        word,
        low,
        f.at(low, high),
        0 if c.word.shift > word.shift else c.left,
        0 if c.word.shift > word.shift else c.right,
    )


def _divided(c: Curve, bits: int) -> Curve:
    """The function over 2^bits, which divides it."""
    return (
        c
        if bits == 0
        else Curve(c.word, c.first, c.values >> bits, c.left >> bits, c.right >> bits)
    )


def _alike(a: Base, b: Base) -> bool:
    """Whether the terms of one can be those of the other times a power of two, but for what a
    floor drops."""
    spans = [
        (p.ends[1] - p.ends[0], q.ends[1] - q.ends[0])
        for p, q in ((c, b.total.terms[w]) for w, c in a.total.terms.items())
    ]
    wide = max(spans)
    j = round(np.log2(wide[0] / wide[1]))
    return all(
        abs(p - (q << j)) < 2 << j if j >= 0 else abs((p << -j) - q) < 2 << -j for p, q in spans
    )


def _moved(term: Curve) -> "Value":
    """A function of a floor of a sum that is itself the floor of another, as a function of that."""
    word = term.word
    assert word.base
    assert word.base.parent
    fine, j, offset, sign = word.base.parent
    shift = word.shift + j
    # sign * base = floor((fine + offset) / 2^j), so word = floor((sign * fine + at) / 2^shift).
    at = (offset if sign > 0 else (1 << j) - 1 - offset) + (word.offset << j)
    if sign < 0:
        at = (1 << shift) - 1 - at
    other = fine.word(at % (1 << shift), shift)
    # word = sign * (other + at >> shift), code by code.
    move = at >> shift
    if sign > 0:
        low, high, values, left, right = (
            term.first - move,
            term.last - move,
            term.values,
            term.left,
            term.right,
        )
    else:
        low, high, values, left, right = (
            -term.last - move,
            -term.first - move,
            term.values[::-1],
            -term.right,
            -term.left,
        )
    if low < other.low or high > other.high:
        # Its own bounds were not as sharp.
        a, b = max(low, other.low), min(high, other.high)
        values, low = values[a - low : b - low + 1], a
    made, start = curve(other, low, values, left, right)
    return value(start, {} if made is None else {other: made})


def _straight(word: Word, slope: int) -> Curve:
    return Curve(word, word.low, np.zeros(1, dtype=np.int64), slope, slope)


def _fits(*numbers: int) -> None:
    """Arrays have 64 bits: whatever could exceed 62 is refused."""
    if any(abs(n) >= MOST for n in numbers):
        raise UnsupportedError("a number of more than 62 bits")


def curve(
    word: Word, first: int, values: np.ndarray, left: int, right: int
) -> tuple[Curve | None, int]:
    """The function in its shortest form, or None for a constant, and its value at the lowest
    code."""
    _fits(int(values.min()), int(values.max()))
    if first == word.low and len(values) > 1:
        left = int(values[1]) - int(values[0])
    if first + len(values) - 1 == word.high and len(values) > 1:
        right = int(values[-1]) - int(values[-2])
    begin = end = 0
    if len(values) > 1:
        steps = np.diff(values)
        other = steps != left
        begin = int(other.argmax()) if other.any() else len(steps)
        other = steps != right
        end = int(other[::-1].argmax()) if other.any() else len(steps)
    before, behind = first - word.low, word.high - first - len(values) + 1
    last = len(values) - 1
    if (begin == last and (left == right or not behind)) or (end == last and not before):
        # One straight line from end to end.
        slope = left if begin == last and (begin or before) else right
        start = int(values[0]) - slope * before
        _fits(start, slope * (word.high - word.low))
        return (None if slope == 0 else _straight(word, slope)), start
    if left and begin + before < LEAST_LINE:
        values = np.concatenate([int(values[0]) - left * np.arange(before, 0, -1), values])
        first, begin, left, before = word.low, 0, 0, 0
    if right and end + behind < LEAST_LINE:
        values = np.concatenate([values, int(values[-1]) + right * np.arange(1, behind + 1)])
        end = right = behind = 0
    first, values = first + begin, values[begin : len(values) - end]
    _fits(left * (first - word.low), right * (word.high - first))
    start = int(values[0]) - left * (first - word.low)
    return Curve(word, first, values - start, left, right), start


class Sum:
    """A constant and functions of words."""

    __slots__ = ("_ends", "constant", "terms")

    def __init__(
        self, constant: int, terms: dict[Word, Curve], ends: tuple[int, int] | None = None
    ):
        self.constant, self.terms, self._ends = constant, terms, ends

    @property
    def ends(self) -> tuple[int, int]:
        """Bounds that hold for every frame; exact for terms that do not hang together."""
        if self._ends is None:
            low = high = self.constant
            for term in self.terms.values():
                a, b = term.ends
                low, high = low + a, high + b
            self._ends = low, high
            if any(w.base for w in self.terms):
                self._ends = self._relaxed()
        return self._ends

    def _relaxed(self) -> tuple[int, int]:
        """Bounds where the latest floor is read as its sum over 2^s, less 0 to 1 - 2^-s: its sum
        may cancel."""
        assert self._ends is not None
        word = max(
            (w for w, c in self.terms.items() if w.base and c.line),
            key=lambda w: w.number,
            default=None,
        )
        if word is None or word.base is None:
            return self._ends
        slope, scale = self.terms[word].right, 1 << word.shift
        if (
            max(
                abs(end)
                for pair in (self._ends, ends(word.base.total), (word.offset, slope))
                for end in pair
            )
            * scale
            * max(abs(slope), 1)
            >= MOST >> 2
        ):
            return self._ends
        rest = Sum(self.constant, {w: c for w, c in self.terms.items() if w is not word})
        # slope * (word - low) = (slope * (base + offset - r) - slope * low * scale) / scale, r
        # from 0 to scale - 1
        total = plus(
            times(rest, scale), times(plus(word.base.total, word.offset - word.low * scale), slope)
        )
        low, high = ends(total)
        low, high = low - max(slope, 0) * (scale - 1), high - min(slope, 0) * (scale - 1)
        return max(self._ends[0], -(-low // scale)), min(self._ends[1], high // scale)


Value = int | Sum


def ends(v: Value) -> tuple[int, int]:
    return (v, v) if isinstance(v, int) else v.ends


class Function:
    """Something that depends on floors of one sum alone: `codes` of a grid on which all its parts
    are known."""

    def __init__(self, word: Word, constant: int, terms: Iterable[Curve]):
        self.word, self.constant = word, constant
        self.terms = [_stairs(t) if t.word.shift > word.shift else t for t in terms]
        self.steps = [t.word.shift - word.shift for t in self.terms]
        self.shifts = [(t.word.offset - word.offset) >> word.shift for t in self.terms]
        _fits(abs(constant) + sum(max(map(abs, t.ends)) for t in self.terms))

    def on(self, word: Word) -> "Function":
        return Function(word, self.constant, self.terms)

    def window(self) -> tuple[int, int]:
        """Codes outside of which every part is a straight line over its own grid."""
        low, high = self.word.high, self.word.low
        for t, k, s in zip(self.terms, self.steps, self.shifts, strict=True):
            # Of a constant end, the code next to the first change is enough.
            low = min(low, (t.first << k if t.left else (t.first + 1 << k) - 1) - s)
            high = max(high, ((t.last + 1 << k) - 1 if t.right else t.last << k) - s)
        return max(low, self.word.low), min(high, self.word.high)

    def slopes(self) -> tuple[int | None, int | None]:
        """Slopes outside the window; None where it is no line on this grid."""
        sides: list[int | None] = []
        for side in ("left", "right"):
            parts = [(getattr(t, side), k) for t, k in zip(self.terms, self.steps, strict=True)]
            sides.append(None if any(m and k for m, k in parts) else sum(m for m, _ in parts))
        return sides[0], sides[1]

    def at(self, low: int, high: int) -> np.ndarray:
        result = np.full(high - low + 1, self.constant, dtype=np.int64)
        for term, step, shift in zip(self.terms, self.steps, self.shifts, strict=True):
            if step == 0:
                result += term.at(low + shift, high + shift)
            else:
                a, b = low + shift >> step, high + shift >> step
                result += np.repeat(term.at(a, b), 1 << step)[low + shift - (a << step) :][
                    : high - low + 1
                ]
        return result


def value(constant: int, terms: dict[Word, Curve]) -> Value:
    """The sum; a straight line over a whole sum is written as that sum."""
    for word, term in terms.items():
        if word.base is not None and word.shift == 0 and term.line:
            rest = {w: c for w, c in terms.items() if w is not word}
            return plus(
                value(constant, rest),
                times(plus(word.base.total, word.offset - word.low), term.right),
            )
    return Sum(constant, terms) if terms else constant


def plus(a: Value, b: Value) -> Value:
    if isinstance(a, int):
        a, b = b, a
    if isinstance(a, int):
        return a + int(b)  # type: ignore[arg-type]
    if isinstance(b, int):
        return (
            a
            if b == 0
            else Sum(a.constant + b, a.terms, a._ends and (a._ends[0] + b, a._ends[1] + b))
        )
    if len(b.terms) > len(a.terms):
        a, b = b, a
    terms, constant, new = dict(a.terms), a.constant + b.constant, False
    waiting = list(b.terms.items())
    while waiting:
        word, term = waiting.pop()
        old = terms.get(word)
        if old is None:
            other = next((w for w in terms if w.base is word.base), None) if word.base else None
            finer = other and _finer(term, terms[other])
            if other is None or finer is None:
                terms[word] = term
                continue
            # Two grids of one sum become one, so that equal functions have equal terms.
            for c in (term, terms.pop(other)):
                on, start = _refined(c, finer)
                constant, new = constant + start, True
                if on:
                    waiting.append((finer, on))
            continue
        low, high = min(old.first, term.first), max(old.last, term.last)
        summed, start = curve(
            word,
            low,
            old.at(low, high) + term.at(low, high),
            old.left + term.left,
            old.right + term.right,
        )
        constant, new = constant + start, True
        if summed is None:
            del terms[word]
        else:
            terms[word] = summed
    return value(constant, terms) if new else Sum(constant, terms)


def times(v: Value, factor: int) -> Value:
    if isinstance(v, int) or factor == 0:
        return v * factor if isinstance(v, int) else 0
    if factor == 1:
        return v
    low, high = sorted((v._ends[0] * factor, v._ends[1] * factor)) if v._ends else (0, 0)
    return Sum(
        v.constant * factor,
        {w: c.times(factor) for w, c in v.terms.items()},
        (low, high) if v._ends else None,
    )


def minus(a: Value, b: Value) -> Value:
    return plus(a, times(b, -1))


def _twos(number: int) -> int:
    return (number & -number).bit_length() - 1


def _stairs(t: Curve) -> Curve:
    """A function of a word of few codes with constant ends, since on a finer grid its lines are
    stairs."""
    if not (t.left or t.right) or t.word.high - t.word.low >= FEW:
        return t
    return Curve(t.word, t.word.low, t.at(t.word.low, t.word.high), 0, 0)


class Space:
    """All words of one proof."""

    def __init__(self) -> None:
        self.bases: dict[tuple[int, ...], list[Base]] = {}
        self.related: dict[tuple[Base, Base], bool] = {}
        self.alike: dict[frozenset[Word], list[Base]] = {}
        # The sums that turned out to be floors of others.
        self.found: list[Base] = []

    def sample(self, name: str, low: int, high: int) -> Value:
        word = Word(next(_numbers), name, low, high)
        return Sum(low, {word: Curve(word, low, np.zeros(1, dtype=np.int64), 1, 1)})

    def flat(self, v: Value, roots: bool = True) -> Value:
        """v with floors of floors as those of the finest sum and, with `roots`, those of one
        sample written code by code."""
        if isinstance(v, int):
            return v
        for word in v.terms:
            if word.base and not word.base.parent and word.base.seen != len(self.found):
                self._refresh(word.base)
        if not any((roots and w.root) or w.moves for w in v.terms):
            return v
        result = value(
            v.constant,
            {w: c for w, c in v.terms.items() if not (roots and w.root) and not w.moves},
        )
        for word, term in v.terms.items():
            root = word.root
            if root and roots:
                inner, start = word.flat()
                if inner is None:
                    result = plus(result, int(term.at(word.low + start, word.low + start)[0]))
                    continue
                codes = inner.at(root.low, root.high) + start
                made, begin = curve(root, root.low, term.at(word.low, word.high)[codes], 0, 0)
                result = plus(result, value(begin, {} if made is None else {root: made}))
            elif word.moves:
                result = plus(result, self.flat(_moved(term), roots))
        return result

    def _refresh(self, base: Base) -> None:
        """Where words of a sum have turned out to be floors of others, so is the sum."""
        base.seen = len(self.found)
        total = self.flat(base.total)
        if total is not base.total and isinstance(total, Sum):
            other, e, sign = self._base(total)
            if e == 0 and base not in other.above() and not other.uses(base):
                base.parent = other, 0, sign * total.constant, sign

    def _relate(self, a: Base, b: Base) -> bool:
        """Whether one sum is the floor of the other by a power of two: their difference then keeps
        within it."""
        if a is b:
            return True
        if (a, b) not in self.related:
            self.related[a, b] = self.related[b, a] = False
            (al, ah), (bl, bh) = ends(a.total), ends(b.total)
            fine, coarse = (a, b) if ah - al >= bh - bl else (b, a)
            ratio = max(ah - al, bh - bl) / max(1, min(ah - al, bh - bl))
            near = max(0, round(np.log2(ratio)))
            for j in sorted({max(0, near - 1), near, near + 1}):
                for sign in (1, -1):
                    d = self._settled(minus(fine.total, times(coarse.total, sign << j)))
                    low, high = ends(d)
                    if coarse.parent or coarse in fine.above() or fine.uses(coarse):
                        continue
                    if high - low < 1 << j:
                        coarse.parent = fine, j, -low, sign
                        self.found.append(coarse)
                        self.related[a, b] = self.related[b, a] = True
                        return True
        return self.related[a, b]

    def _settled(self, v: Value) -> Value:
        """v after pairs of its words that cancel in part have been related."""
        v = self.flat(v)
        if isinstance(v, Sum):
            made = list(dict.fromkeys(w.base for w in v.terms if w.base))
            for k, a in enumerate(made if len(made) <= MOST_PAIRED else ()):
                for b in made[:k]:
                    if not a.parent and not b.parent:
                        self._relate(a, b)
            v = self.flat(v)
        return v

    def _base(self, v: Sum) -> tuple[Base, int, int]:
        """The base of a sum of several words, with its power of two and its sign: v = constant +
        sign * 2^e * base."""
        bits = 0
        for term in v.terms.values():
            bits |= term.bits()
        e = _twos(bits)
        first = v.terms[min(v.terms, key=lambda w: w.number)]
        step = (
            first.left
            or int(
                (first.values - first.values[0])[
                    np.flatnonzero(first.values - first.values[0])[:1]
                ].sum()
            )
            or first.right
        )
        sign = 1 if step > 0 else -1
        terms = {}
        for word, term in sorted(v.terms.items(), key=lambda t: t[0].number):
            terms[word] = (
                term
                if e == 0 and sign == 1
                else Curve(
                    word,
                    term.first,
                    sign * (term.values >> e),
                    sign * (term.left >> e),
                    sign * (term.right >> e),
                )
            )
        key = tuple(
            x
            for w, c in terms.items()
            for x in (w.number, c.first, c.left, c.right, len(c.values), hash(c.values.tobytes()))
        )
        found = self.bases.setdefault(key, [])
        for base in found:
            # The key only finds candidates: the arrays decide.
            if all(
                c.same(o) for c, o in zip(terms.values(), base.total.terms.values(), strict=True)
            ):
                return base, e, sign
        base = Base(Sum(0, terms))
        found.append(base)
        alike = self.alike.setdefault(frozenset(terms), [])
        for other in alike:
            if not other.parent and not base.parent and _alike(base, other):
                self._relate(base, other)
        alike.append(base)
        return base, e, sign

    def floor(self, v: Value, k: int) -> Value:
        """floor(v / 2^k)."""
        if isinstance(v, int) or k == 0:
            return v >> k if isinstance(v, int) else v
        resolved = self.flat(v, roots=False)
        if isinstance(resolved, int):
            return resolved >> k
        v, out = self._through(resolved, k)
        if isinstance(v, int):
            return plus(out, v >> k)
        low, high = v.ends
        if low >> k == high >> k:
            return plus(out, low >> k)
        e = self._one_low(v, k)
        if e:
            below = value(
                v.constant % (1 << e), {w: c for w, c in v.terms.items() if _twos(c.bits()) < e}
            )
            rest = value(
                v.constant >> e,
                {w: _divided(c, e) for w, c in v.terms.items() if _twos(c.bits()) >= e},
            )
            return plus(out, self.floor(plus(rest, self.floor(below, e)), k - e))
        whole = self._whole(v, k)
        if whole is not None:
            return plus(out, self.floor(*whole))
        if len({w.base or w for w in v.terms}) == 1 and not (len(v.terms) == 1 and self._longer(v)):
            return plus(out, self.of(lambda a: a >> k, v))
        if len(v.terms) > 1:
            flat = self.flat(v)
            if isinstance(flat, int) or len(flat.terms) == 1:
                return plus(out, self.floor(flat, k))
            v = flat
            e = self._idle_bits(v, k)
            if e:
                rest = Sum(
                    0, {w: _divided(c, e) for w, c in v.terms.items() if _twos(c.bits()) >= e}
                )
                small = sum(
                    ends(value(0, {w: c}))[0] for w, c in v.terms.items() if _twos(c.bits()) < e
                )
                return plus(out, self.floor(plus(rest, v.constant + small >> e), k - e))
        word, constant, sign = self._line(v, k)
        return plus(plus(out, constant), Sum(0, {word: _straight(word, sign)}))

    def _longer(self, v: Sum) -> bool:
        """Whether a line over a word is so long that its floor is better a word of its own."""
        ((word, term),) = v.terms.items()
        return term.line and (word.base is None or word.high - word.low >= LONGEST)

    def _one_low(self, v: Sum, k: int) -> int:
        """How many low bits a single floor reaches: it can be cut before it is added."""
        twos = {w: _twos(c.bits()) for w, c in v.terms.items()}
        for e in sorted({t for t in twos.values() if 0 < t <= k}, reverse=True):
            low = [w for w in twos if twos[w] < e]
            if len(low) == 1 and low[0].base and v.terms[low[0]].line and not low[0].root:
                return e
        return 0

    def _idle_bits(self, v: Sum, k: int) -> int:
        """How many low bits of v, which only some small terms reach, never carry into those
        above."""
        twos = {w: _twos(c.bits()) for w, c in v.terms.items()}
        for e in sorted({t for t in twos.values() if 0 < t <= k}, reverse=True):
            small = [c.ends for w, c in v.terms.items() if twos[w] < e]
            low, high = (v.constant + sum(c[side] for c in small) for side in (0, 1))
            if small and low >> e == high >> e:
                return e
        return 0

    def _line(self, v: Sum, k: int) -> tuple[Word, int, int]:
        """floor(v / 2^k) as constant + sign * (word - its lowest code)."""
        flat = self.flat(v)
        assert isinstance(flat, Sum)
        v = flat
        base, e, sign = self._base(v)
        if e >= k:
            word = base.word(0, 0)
            constant, slope = (v.constant >> k) + sign * (word.low << e - k), sign << e - k
        else:
            k, offset = k - e, v.constant >> e
            if sign < 0:
                offset = (1 << k) - 1 - offset
            word = base.word(offset % (1 << k), k)
            constant, slope = sign * ((offset >> k) + word.low), sign
        while word.moves:
            moved = _moved(_straight(word, slope))
            assert isinstance(moved, Sum)
            ((word, line),) = moved.terms.items()
            constant, slope = constant + moved.constant, line.right
        return word, constant, slope

    def _through(self, v: Sum, k: int) -> tuple[Value, Value]:
        """v as rest + 2^k * whole, where every term that 2^k divides, and lines as far as it does,
        are in whole."""
        rest, whole, half = {}, {}, 1 << k - 1
        for word, term in v.terms.items():
            if term.line:
                small = (
                    term.right if abs(term.right) <= half else (term.right + half) % (1 << k) - half
                )
                if small:
                    rest[word] = (
                        Curve(word, term.first, term.values, small, small)
                        if small != term.right
                        else term
                    )
                if small != term.right:
                    m = term.right - small >> k
                    whole[word] = Curve(word, term.first, term.values, m, m)
            elif _twos(term.bits()) >= k:
                whole[word] = _divided(term, k)
            else:
                rest[word] = term
        constant = v.constant % (1 << k)
        return value(constant, rest), value(v.constant >> k, whole)

    def _whole(self, v: Sum, k: int) -> tuple[Value, int] | None:
        """floor(v / 2^k) as the floor of a sum in which the latest floor is replaced by its sum,
        if that is allowed.

        floor((floor(t / 2^s) + x) / 2^k) = floor((t + 2^s * x) / 2^(s + k)) for every integer x.
        """
        for word in sorted(
            (w for w, c in v.terms.items() if w.base and c.line),
            key=lambda w: (-w.shift, -w.number),
        ):
            f = v.terms[word].right
            j = _twos(f)
            if abs(f) != 1 << j or word.base is None or j > k:
                continue
            others = {w: c for w, c in v.terms.items() if w is not word}
            constant = v.constant - f * word.low
            if any(_twos(c.bits()) < j for c in others.values()):
                continue
            x = value(constant >> j, {w: _divided(c, j) for w, c in others.items()})
            if max(map(abs, ends(x))) << word.shift >= MOST >> 1:
                continue
            t = plus(word.base.total, word.offset)
            if f < 0:
                t = minus((1 << word.shift) - 1, t)
            return plus(t, times(x, 1 << word.shift)), word.shift + k - j
        return None

    def function(self, v: Value) -> Function | None:
        """v as a function of one word, or None for a constant."""
        if isinstance(v, int):
            return None
        if any(w.moves for w in v.terms) or (
            any(w.root for w in v.terms) and len({w.root or w for w in v.terms}) == 1
        ):
            v = self.flat(v)
            if isinstance(v, int):
                return None
        if len({w.base or w for w in v.terms}) == 1:
            return Function(_common(v.terms), v.constant, list(v.terms.values()))
        # A sum beside functions of its own floors is a function of it.
        bases = sorted(
            {w.base for w in v.terms if w.base},
            key=lambda b: -min(w.number for w in b.words.values()),
        )
        for base in bases:
            mine = {w: c for w, c in v.terms.items() if w.base is base}
            rest = {w: c for w, c in v.terms.items() if w.base is not base}
            found = self._as_line(Sum(v.constant, rest), base)
            if found:
                word, constant, slope = found
                return Function(
                    _common([word, *mine]), constant, [_straight(word, slope), *mine.values()]
                )
        found = self._as_line(v)
        assert found
        word, constant, slope = found
        if word.moves:
            return self.function(plus(constant, Sum(0, {word: _straight(word, slope)})))
        return Function(word, constant, [_straight(word, slope)])

    def _as_line(self, v: Sum, wanted: Base | None = None) -> tuple[Word, int, int] | None:
        """v as constant + slope * (word - its lowest code), if that is a word of the wanted
        base."""
        bits = 0
        for term in v.terms.values():
            bits |= term.bits()
        e = _twos(bits)
        t, k = self._unfloored(Sum(0, {w: _divided(c, e) for w, c in v.terms.items()}), 0)
        if wanted and t.terms.keys() != wanted.total.terms.keys():
            return None
        word, constant, slope = self._line(t, k)
        return (
            None
            if wanted and word.base is not wanted
            else (word, v.constant + (constant << e), slope << e)
        )

    def _unfloored(self, v: Sum, k: int) -> tuple[Sum, int]:
        """floor(v / 2^k) as the floor of a sum without floors, as far as that is allowed."""
        while True:
            resolved = self.flat(v, roots=False)
            assert isinstance(resolved, Sum)
            whole = self._whole(resolved, k)
            if whole is None:
                return resolved, k
            inner, k = whole
            assert isinstance(inner, Sum)
            v = inner

    def of(self, f: Callable[..., Any], *values: Value) -> Value:
        """f(values), code by code; all of them are functions of one word."""
        functions = self._together(*values)
        word = next((g.word for g in functions if g), None)
        if word is None:
            return int(f(*[self._known(v) for v in values]))
        low, high = word.high, word.low
        for g in functions:
            if g:
                a, b = g.window()
                left, right = g.slopes()
                low, high = (
                    min(low, word.low if left != 0 else a - 1),
                    max(high, word.high if right != 0 else b + 1),
                )
        return self._made(
            word,
            max(low, word.low),
            min(high, word.high),
            lambda a, b: f(
                *[
                    g.at(a, b) if g else self._known(v)
                    for g, v in zip(functions, values, strict=True)
                ]
            ),
        )

    def _known(self, v: Value) -> Any:
        """The number that a value is which is no function of any word."""
        known = self.flat(v)
        assert isinstance(known, int)
        return np.int64(known)

    def _made(self, word: Word, low: int, high: int, f: Callable[[int, int], Any]) -> Value:
        if high - low >= LONGEST:
            raise UnsupportedError(f"a function of a word that takes {high - low} values")
        values = np.broadcast_to(np.asarray(f(low, high), dtype=np.int64), high - low + 1)
        made, start = curve(word, low, values, 0, 0)
        return value(start, {} if made is None else {word: made})

    def _together(self, *values: Value) -> list[Function | None]:
        """The values as functions of one and the same word."""
        functions = [self.function(v) for v in values]
        for _ in values:
            bases = list(dict.fromkeys(g.word.base for g in functions if g and g.word.base))
            related = [self._relate(bases[0], b) for b in bases[1:]]
            if not any(related):
                break
            functions = [self.function(v) for v in values]
        words = [g.word for g in functions if g]
        if len({w.base or w for w in words}) > 1:
            raise UnsupportedError(
                "a function of words that depend on different samples: "
                + ", ".join(sorted({describe(w) for w in words}))
            )
        if not words:
            return functions
        common = _common(words)
        return [g.on(common) if g else None for g in functions]

    def negative(self, v: Value) -> Value:
        """1 where v < 0, else 0: no more than the floor over a power of two that is greater than
        the magnitude of v."""
        low, high = ends(v)
        if low >= 0 or high < 0:
            return int(high < 0)
        return times(self.floor(v, max(-low - 1, high).bit_length()), -1)

    def zero(self, v: Value) -> Value:
        """1 where v is 0, else 0."""
        low, high = ends(v)
        if low > 0 or high < 0:
            return 0
        return self.of(lambda a: (a == 0).astype(np.int64), v)

    def choose(self, c: Value, x: Value, y: Value) -> Value:
        """x where c is 1, y where c is 0."""
        if isinstance(c, int):
            return x if c else y
        d = minus(x, y)
        if isinstance(d, int):
            return plus(y, times(c, d))
        try:
            chooser, *branches = self._together(c, x, y)
        except UnsupportedError:
            chooser, *branches = (self.function(v) for v in (c, x, y))
        if chooser is None:
            return x if self._known(c) else y
        if all(
            g is None or (g.word.base or g.word) is (chooser.word.base or chooser.word)
            for g in branches
        ):
            common = _common([g.word for g in (chooser, *branches) if g])
            first, second = (
                g.on(common) if g else int(self._known(v))
                for g, v in zip(branches, (x, y), strict=True)
            )
            return self._picked(chooser.on(common), first, second)
        # y + c * (x - y) hangs on one word wherever x - y does.
        chooser, difference = self._together(c, d)
        assert chooser
        if difference is None:
            return plus(y, times(c, int(self._known(d))))
        return plus(y, self._picked(chooser, difference, 0))

    def _picked(self, c: Function, x: "Function | int", y: "Function | int") -> Value:
        """The choice code by code; each branch is looked at only where it is chosen."""
        word = c.word
        a, b = c.window()
        # Outside its window the choice is constant, unless it is no step function there.
        left, right = c.slopes()
        a = word.low if left != 0 else max(a - 1, word.low)
        b = word.high if right != 0 else min(b + 1, word.high)
        slopes = []
        for side, code in ((0, a), (1, b)):
            branch = x if c.at(code, code)[0] else y
            slope = 0
            if isinstance(branch, Function):
                found = branch.slopes()[side]
                end = branch.window()[side]
                if side == 0:
                    a = min(a, word.low if found is None else max(end - 1, word.low))
                else:
                    b = max(b, word.high if found is None else min(end + 1, word.high))
                slope = found or 0
            slopes.append(slope)
        if b - a >= LONGEST:
            raise UnsupportedError(f"a choice over a word that takes {b - a} values")
        chosen = c.at(a, b) != 0
        result = np.empty(b - a + 1, dtype=np.int64)
        for where, branch in ((chosen, x), (~chosen, y)):
            if isinstance(branch, int):
                result[where] = branch
                continue
            codes = np.flatnonzero(where)
            if len(codes):
                p, q = int(codes[0]), int(codes[-1])
                part = branch.at(a + p, a + q)
                np.copyto(result[p : q + 1], part, where=where[p : q + 1])
        made, start = curve(word, a, result, *slopes)
        return value(start, {} if made is None else {word: made})

    def clip(self, v: Value, low: int, high: int) -> Value:
        a, b = ends(v)
        if low <= a and b <= high:
            return v
        v = self.choose(self.negative(minus(v, low)), low, v)
        return self.choose(self.negative(minus(high, v)), high, v)

    def reduced(self, v: Value, bits: int) -> Value:
        """v without what 2^bits divides."""
        return v if isinstance(v, int) else self._through(v, bits)[0]

    def modulo(self, v: Value, bits: int, signed: bool) -> Value:
        """The number from 0, or from -2^(bits - 1) on, that is v modulo 2^bits."""
        low = -(1 << bits - 1) if signed else 0
        if isinstance(v, int):
            return (v - low) % (1 << bits) + low
        a, b = v.ends
        if low <= a and b < low + (1 << bits):
            return v
        rest, _ = self._through(v, bits)
        result = plus(rest, times(self.floor(plus(rest, -low), bits), -(1 << bits)))
        if isinstance(result, Sum):
            a, b = result.ends
            result = Sum(
                result.constant, result.terms, (max(a, low), min(b, low + (1 << bits) - 1))
            )
        return result

    def equal(self, a: Value, b: Value) -> bool:
        """Whether a and b are the same for every frame."""
        d = self._settled(minus(a, b))
        if isinstance(d, int):
            return d == 0
        groups: dict[Any, dict[Word, Curve]] = {}
        for word, term in d.terms.items():
            groups.setdefault(word.base or word, {})[word] = term
        rest: Value = d.constant
        for terms in groups.values():
            part: Value = Sum(0, terms)
            if len(terms) > 1:
                part = self.of(lambda v: v, part)
            rest = plus(rest, part)
        if not isinstance(rest, int) and any(w.base for w in rest.terms) and len(groups) > 1:
            try:
                rest = self.of(lambda v: v, rest)
            except UnsupportedError:
                return False
        return rest == 0 if isinstance(rest, int) else False


def describe(word: Word) -> str:
    """The samples that a word depends on."""
    names: set[str] = set()

    def visit(w: Word) -> None:
        if w.base is None:
            names.add(w.name)
        else:
            for inner in w.base.total.terms:
                visit(inner)

    visit(word)
    return "(" + " ".join(sorted(names)) + ")"
