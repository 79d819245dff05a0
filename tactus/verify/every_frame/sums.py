"""What a word of hardware holds, taken over all frames at once: a sum of functions of one word
each.

A `Sum` is a constant and, for each of some words, a function of that word alone, given at the codes
where its slope changes. It is an exact integer for every frame. A word is a sample, or the floor of
a sum over a power of two that was met on the way. Two rules make new sums of old ones:

- what is linear (sum, difference, product with a constant) works term by term;
- any function of one word works code by code, and a sum of several words becomes one word first.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

# The most codes of a word whose functions are written out code by code.
LONGEST = 1 << 24
MOST = 1 << 62
# A function that rises or falls at fewer codes may be written as a staircase on a finer grid.
FEW = 1 << 17
# A slope of a function is rounded to 2^-PARTS or more.
PARTS = 8
_numbers = itertools.count(1)


class UnsupportedError(Exception):
    """What the method cannot decide. It is never taken for a proof, and never for a difference."""


@dataclass(eq=False)
class Word:
    """A number that takes the codes low to high: the sample of a name, or floor((base + offset) /
    2^shift)."""

    number: int
    name: str
    low: int
    high: int
    base: "Base | None" = None
    offset: int = 0
    shift: int = 0


class Base:
    """A sum of several words, without a constant, of which words are floors.

    `coarse` says that it is start + sign * word, for a word of another sum. `parts` are two values
    of which it is the sum, but for a constant, with how many powers of two divide the second.
    """

    def __init__(self, total: "Sum"):
        self.total, self.number = total, next(_numbers)
        self.coarse: tuple[int, int, Word] | None = None
        self.parts: tuple[Value, Value, int] | None = None
        self.words: dict[tuple[int, int], Word] = {}

    def word(self, offset: int, shift: int) -> Word:
        """floor((sum + offset) / 2^shift), for an offset from 0 to 2^shift - 1."""
        _fits(offset)
        key = offset, shift
        if key not in self.words:
            low, high = (end + offset >> shift for end in ends(self.total))
            self.words[key] = Word(next(_numbers), "", low, high, self, offset, shift)
        return self.words[key]


class Curve:
    """A function of one word: 0 at its lowest code, and straight between codes where it turns.

    The codes are those where the slope changes, and both ends, so that equal functions have equal
    codes and values.
    """

    def __init__(self, word: Word, codes: np.ndarray, values: np.ndarray):
        self.word, self.codes, self.values = word, codes, values

    @cached_property
    def _hash(self) -> int:
        return hash((self.word.number, self.codes.tobytes(), self.values.tobytes()))

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return self is other or (
            isinstance(other, Curve)
            and self.word is other.word
            and np.array_equal(self.codes, other.codes)
            and np.array_equal(self.values, other.values)
        )

    @cached_property
    def slopes(self) -> np.ndarray:
        """The slope behind each code but the last; a division without a rest."""
        return np.diff(self.values) // np.diff(self.codes)

    @property
    def line(self) -> int:
        """The slope, if it is one straight line, else 0."""
        return int(self.slopes[0]) if len(self.codes) == 2 else 0

    def at(self, codes: np.ndarray) -> np.ndarray:
        place = np.searchsorted(self.codes[1:-1], codes, side="right")
        return self.values[place] + self.slopes[place] * (codes - self.codes[place])

    @property
    def rising(self) -> int:
        """The number of codes at which it is not what it is one code before."""
        return int(np.diff(self.codes)[self.slopes != 0].sum())

    def steps(self) -> np.ndarray:
        """These codes."""
        sloped = self.slopes != 0
        return _every(self.codes[:-1][sloped] + 1, np.diff(self.codes)[sloped])

    @cached_property
    def ends(self) -> tuple[int, int]:
        """The least and the greatest value."""
        return int(self.values.min()), int(self.values.max())

    @cached_property
    def slant(self) -> tuple[int, int, int, int]:
        """A slope and a scale: 2^scale times the function, less a straight line of this slope from
        the lowest code on, is the third to the fourth. The slope is 0 unless it is near a line."""
        run, rise = self.word.high - self.word.low, int(self.values[-1])
        if self.line:
            return self.line, 0, 0, 0
        if max(run, *map(abs, self.ends)) << PARTS + 2 >= MOST:
            return 0, 0, *self.ends
        # A sum of floors of one sum rises by parts of a small power of two.
        for scale in range(PARTS + 1):
            slope = round((rise << scale) / run)
            if abs((rise << scale) - slope * run) <= 4 << scale:
                break
        # Between its codes the difference is straight too, so its ends are at codes.
        rest = (self.values << scale) - slope * (self.codes - self.word.low)
        least, most = int(rest.min()), int(rest.max())
        near = most - least << 2 < int(np.ptp(self.values)) << scale
        return (slope, scale, least, most) if near else (0, 0, *self.ends)

    def __mul__(self, k: int) -> "Curve":
        if k == 1:
            return self
        _fits(*(end * k for end in self.ends))
        return Curve(self.word, self.codes, self.values * k)

    def __floordiv__(self, k: int) -> "Curve":
        """The function over a number that divides it."""
        return self if k == 1 else Curve(self.word, self.codes, self.values // k)

    @cached_property
    def content(self) -> int:
        """The greatest number that divides every difference."""
        return int(np.gcd.reduce(self.slopes))


def _in_order(parts: Sequence[Any]) -> np.ndarray:
    """All these codes, each once."""
    codes = np.sort(np.concatenate(parts), kind="stable")
    return codes[np.append(True, codes[1:] != codes[:-1])]


def _every(starts: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """So many codes from each start on."""
    total = int(counts.sum())
    if total >= LONGEST:
        raise UnsupportedError(f"a function of a word that takes {total} values")
    return np.repeat(starts - np.cumsum(counts) + counts, counts) + np.arange(total)


def _common(words: Sequence[Word]) -> Word:
    """The coarsest grid of which the grids of all these words of one sum are parts."""
    first = words[0]
    if not first.base:
        return first
    apart = [w.offset - first.offset for w in words]
    shift = min([w.shift for w in words] + [_twos(offset) for offset in apart if offset])
    return first.base.word(first.offset % (1 << shift), shift)


def _finer(a: Curve, b: Curve) -> Word | None:
    """The grid onto which two functions of one sum are put together, if no long straight line
    becomes a staircase."""
    word = _common((a.word, b.word))
    return word if all(c.word.shift == word.shift or c.rising < FEW for c in (a, b)) else None


def _straight(word: Word, slope: int) -> Curve:
    _fits(slope * (word.high - word.low))
    return Curve(word, *np.array([[word.low, word.high], [0, slope * (word.high - word.low)]]))


def _fits(*numbers: int) -> None:
    """Arrays have 64 bits: whatever could exceed 62 is refused."""
    if any(abs(n) >= MOST for n in numbers):
        raise UnsupportedError("a number of more than 62 bits")


def curve(word: Word, codes: np.ndarray, values: np.ndarray) -> tuple[Curve | None, int]:
    """The function that is straight between these codes, of which the first and the last are the
    ends of the word, or None for a constant; and its value at the lowest code."""
    start, least, most = int(values[0]), int(values.min()), int(values.max())
    _fits(least, most, most - least)
    if len(codes) == 1:
        return None, start
    slopes = np.diff(values) // np.diff(codes)
    kept = np.concatenate([[True], slopes[1:] != slopes[:-1], [True]])
    codes, values = codes[kept], values[kept] - start
    return (_plain(Curve(word, codes, values)) if values.any() else None), start


def _step(base: Base, place: int, height: int) -> Curve:
    """0 below a place of a sum, and the height from there on, which has this one form."""
    low, high = ends(base.total)
    shift = (high - low).bit_length()
    return _straight(base.word(-place % (1 << shift), shift), height)


def _plain(c: Curve) -> Curve:
    """A staircase over the floors of a sum on the coarsest grid that has its steps, which is its
    one form."""
    word, sloped = c.word, c.slopes != 0
    if word.base is None or (np.diff(c.codes)[sloped] > 1).any():
        return c
    steps = c.codes[1:][sloped]
    apart = int(np.bitwise_or.reduce(steps - steps[0]))
    place = (int(steps[0]) << word.shift) - word.offset
    if not apart:
        return _step(word.base, place, int(c.values[-1]))
    k = _twos(apart)
    if k == 0:
        return c
    coarse = word.base.word(-place % (1 << word.shift + k), word.shift + k)
    first = place + coarse.offset >> coarse.shift
    # The codes of the coarse grid, and before each step the code in front of it.
    at = first + (steps - steps[0] >> k)
    codes = _in_order([[coarse.low, coarse.high], at - 1, at])
    finer = np.clip(steps[0] + (codes - first << k), word.low, word.high)
    return curve(coarse, codes, c.at(finer))[0] or c


class Sum:
    """A constant and functions of words."""

    def __init__(self, constant: int, terms: dict[Word, Curve]):
        self.constant, self.terms = constant, terms
        self._spreads: dict[bool, tuple[Value, int, int, int]] = {}

    @cached_property
    def content(self) -> int:
        """The greatest number that divides every difference."""
        return math.gcd(*(term.content for term in self.terms.values()))

    @property
    def bare(self) -> tuple[int, int]:
        """The sums of the ends of the terms."""
        spans = [term.ends for term in self.terms.values()]
        return self.constant + sum(s[0] for s in spans), self.constant + sum(s[1] for s in spans)

    @cached_property
    def ends(self) -> tuple[int, int]:
        """Bounds that hold for every frame; exact for terms that do not hang together."""
        low, high = self.bare
        for near in (False, True):
            with suppress(UnsupportedError):
                total, scale, below, above = self.spread(near)
                a, b = (total, total) if isinstance(total, int) else total.bare
                # An integer, so its bounds are too.
                low, high = max(low, -(-(a + below) >> scale)), min(high, b + above >> scale)
        return low, high

    def spread(self, near: bool) -> "tuple[Value, int, int, int]":
        """2^scale times the sum is the first, plus something from the third to the last: a floor is
        its sum over 2^s, less 0 to 1 - 2^-s, and so is a function of it that is a straight line, or
        near one."""
        if near not in self._spreads:
            self._spreads[near] = self._spread(near)
        return self._spreads[near]

    def _spread(self, near: bool) -> "tuple[Value, int, int, int]":
        lines = {w: c.slant for w, c in self.terms.items() if c.line or (near and c.slant[0])}
        floors = [(w, s, w.base.total.spread(near)) for w, s in lines.items() if w.base]
        scale = max((w.shift + slant[1] + inner[1] for w, slant, inner in floors), default=0)
        rest = {w: c for w, c in self.terms.items() if not (w.base and w in lines)}
        total, below, above = Sum(self.constant, rest) * (1 << scale), 0, 0
        for word, (slope, e, least, most), (sums, k, low, high) in floors:
            up = slope << scale - e - k - word.shift
            low -= (1 << k + word.shift) - (1 << k)
            below += min(up * low, up * high) + (least << scale - e)
            above += max(up * low, up * high) + (most << scale - e)
            total += (sums + ((word.offset << k) - (word.low << k + word.shift))) * up
        return total, scale, below, above

    def __add__(self, other: "Value") -> "Value":
        if isinstance(other, int):
            return Sum(self.constant + other, self.terms)
        more, fewer = sorted((self, other), key=lambda v: -len(v.terms))
        terms, constant = dict(more.terms), more.constant + fewer.constant
        waiting = [*fewer.terms.values()]
        while waiting:
            term = waiting.pop()
            base, beside = term.word.base, terms.get(term.word)
            if base and not beside:
                beside = next((c for c in terms.values() if c.word.base is base), None)
            word = beside and _finer(term, beside)
            if not beside or not word:
                terms[term.word] = term
                continue
            # Two functions of one sum become one, so that equal functions have equal terms.
            del terms[beside.word]
            both = Function(word, 0, [term, beside])
            made, start = curve(word, both.codes, both.at(both.codes))
            constant += start
            if made:
                waiting.append(made)
        return Sum(constant, terms) if terms else constant

    def __mul__(self, factor: int) -> "Value":
        if factor == 0:
            return 0
        if factor == 1:
            return self
        return Sum(self.constant * factor, {w: c * factor for w, c in self.terms.items()})

    def __neg__(self) -> "Value":
        return self * -1

    def __invert__(self) -> "Value":
        return -self + -1

    def __sub__(self, other: "Value") -> "Value":
        return self + -other

    def __rsub__(self, other: int) -> "Value":
        return -self + other

    __radd__, __rmul__ = __add__, __mul__


Value = int | Sum


def ends(v: Value) -> tuple[int, int]:
    return (v, v) if isinstance(v, int) else v.ends


class Function:
    """A constant and functions of floors of one sum, at the codes of a grid on which all of them
    are known."""

    def __init__(self, word: Word, constant: int, terms: Iterable[Curve]):
        self.word, self.constant = word, constant
        # Each with the bits that its grid is coarser, and how far it is shifted.
        self.parts = [
            (t, t.word.shift - word.shift, (t.word.offset - word.offset) >> word.shift)
            for t in terms
        ]
        _fits(abs(constant) + sum(max(map(abs, t.ends)) for t, _, _ in self.parts))

    @cached_property
    def codes(self) -> np.ndarray:
        """Both ends, and codes between which it is straight."""
        found = [np.array([self.word.low, self.word.high])]
        for t, k, s in self.parts:
            # On a finer grid it is a staircase.
            found += [t.codes] if k == 0 else [(t.steps() << k) - s, (t.steps() << k) - s - 1]
        return _in_order(found)

    def at(self, codes: np.ndarray) -> np.ndarray:
        result = np.full(len(codes), self.constant, dtype=np.int64)
        for term, k, shift in self.parts:
            result += term.at(codes + shift >> k)
        return result


def _drawn(word: Word, codes: np.ndarray, values: np.ndarray) -> Value:
    """The function as `curve` takes it."""
    made, start = curve(word, codes, values)
    return Sum(start, {made.word: made}) if made else start


def _twos(number: int) -> int:
    return (number & -number).bit_length() - 1


def _odd(v: Sum) -> int:
    """The odd factor that all terms have in common."""
    return v.content >> _twos(v.content)


class Space:
    """All words of one proof."""

    def __init__(self) -> None:
        self.bases: dict[tuple[Curve, ...], Base] = {}

    def sample(self, name: str, low: int, high: int) -> Value:
        word = Word(next(_numbers), name, low, high)
        return Sum(low, {word: _straight(word, 1)})

    def cut(self, first: Value, rest: Value) -> None:
        """Note that floors of first + rest are cut first, as far as powers of two divide rest.

        floor((u + 2^k * y) / 2^k) = floor(u / 2^k) + y for every integer y.
        """
        whole = first + rest
        if isinstance(whole, int) or isinstance(first, int) or len(whole.terms) < 2:
            return
        # Parts lead from later sums to earlier ones, so they come to an end.
        inner, _, _ = self._base(first)
        base, e, sign = self._base(whole)
        # What divides the whole divides both, as far as it divides rest.
        most = _twos(rest if isinstance(rest, int) else rest.content | rest.constant) - e
        if inner.number < base.number and most > (base.parts[2] if base.parts else 0):
            first, rest = self.floor(first - whole.constant, e), self.floor(rest, e)
            base.parts = first * sign, rest * sign, most
            for k in range(1, most + 1):
                self._floored(base, sign, whole.constant >> e, k)

    def _base(self, v: Sum) -> tuple[Base, int, int]:
        """The base of a sum of several words, with its power of two and its sign: v = constant +
        sign * 2^e * base."""
        e = _twos(v.content)
        ordered = sorted(v.terms.values(), key=lambda c: c.word.number)
        first = ordered[0].values
        sign = 1 if (first[1] or first[2]) > 0 else -1
        terms = tuple(c // (sign << e) for c in ordered)
        # Equal sums have one base: their arrays are compared.
        if terms not in self.bases:
            self.bases[terms] = Base(Sum(0, {c.word: c for c in terms}))
        base = self.bases[terms]
        return base, e, sign

    def floor(self, v: Value, k: int) -> Value:
        """floor(v / 2^k)."""
        if isinstance(v, int) or k == 0:
            return v >> k if isinstance(v, int) else v
        low, high = v.ends
        if low >> k == high >> k:
            return low >> k
        if v.content % (1 << k) == 0:
            return Sum(v.constant >> k, {w: c // (1 << k) for w, c in v.terms.items()})
        if len({w.base or w for w in v.terms}) > 1:
            # Short ones code by code, so that hardware may wrap a sum and then cut it.
            if _odd(v) > 1 or self._own(v, quick=True):
                with suppress(UnsupportedError):
                    return self.of(lambda a: a >> k, v)
            base, e, sign = self._base(v)
            return self._floored(base, sign, v.constant >> e, k - e)
        ((word, term), *others) = v.terms.items()
        if others or not word.base or abs(term.line).bit_count() != 1:
            return self.of(lambda a: a >> k, v)
        j = _twos(term.line)
        constant = v.constant - term.line * word.low >> j
        return self._below(word, 1 if term.line > 0 else -1, constant, k - j)

    def _below(self, word: Word, sign: int, constant: int, k: int) -> Value:
        """floor((constant + sign * word) / 2^k), for a word that is itself a floor."""
        assert word.base
        s = word.shift
        # -floor(b / 2^s) = floor((2^s - 1 - b) / 2^s)
        offset = word.offset if sign > 0 else (1 << s) - 1 - word.offset
        return self._floored(word.base, sign, offset + (constant << s), k + s)

    def _floored(self, base: Base, sign: int, constant: int, k: int) -> Value:
        """floor((constant + sign * base) / 2^k)."""
        if base.coarse:
            start, turned, word = base.coarse
            return self._below(word, sign * turned, constant + sign * start, k)
        offset = constant if sign > 0 else (1 << k) - 1 - constant
        word = base.word(offset % (1 << k), k)
        start = sign * (offset >> k)
        if word.low == word.high:
            return start + sign * word.low
        if base.parts and k <= base.parts[2]:
            first, rest, _ = base.parts
            form = self.floor(first * sign + constant, k) + self.floor(rest * sign, k)
            if isinstance(form, Sum) and len(form.terms) > 1:
                # form = start + sign * word = form.constant + turned * 2^e * other
                other, e, turned = self._base(form)
                if e == 0 and other.coarse is None and other is not base:
                    other.coarse = turned * (start - form.constant), turned * sign, word
            return form
        line = _plain(_straight(word, sign))
        return Sum(start + sign * word.low, {line.word: line})

    def _parts(self, v: Value) -> tuple[int, list[Curve]]:
        """v as a constant and functions of floors of one sum."""
        if isinstance(v, int):
            return v, []
        if len({w.base or w for w in v.terms}) == 1:
            return v.constant, [*v.terms.values()]
        return self._own(v, quick=False) or self._line(v)

    def _own(self, v: Sum, quick: bool) -> tuple[int, list[Curve]] | None:
        """The same, if it is a sum beside functions of floors of this sum."""
        for base in {w.base: 0 for w in v.terms if w.base}:
            rest = Sum(v.constant, {w: c for w, c in v.terms.items() if w.base is not base})
            if quick and rest.terms.keys() != base.total.terms.keys():
                continue
            constant, line = self._line(rest)
            if all(c.word.base is base for c in line):
                return constant, [*line, *[c for w, c in v.terms.items() if w.base is base]]
        return None

    def _line(self, v: Sum) -> tuple[int, list[Curve]]:
        """The same as a straight line over one word: the sum without a common factor. There is none
        if the sum has one value."""
        odd = _odd(v)
        base, e, slope = self._base(
            Sum(0, {w: c // odd for w, c in v.terms.items()}) if odd > 1 else v
        )
        slope *= odd
        start, turned, word = base.coarse or (0, 1, base.word(0, 0))
        slope <<= e
        constant = v.constant + slope * (start + turned * word.low)
        return constant, [_straight(word, slope * turned)] if word.low < word.high else []

    def of(self, f: Callable[..., Any], *values: Value) -> Value:
        """f(values), code by code; all of them are functions of one word."""
        numbers = [np.int64(v) for v in values if isinstance(v, int)]
        if len(numbers) == len(values):
            return int(f(*numbers))
        given = self._together(*values)
        codes = _in_order([g.codes for g in given])
        # Where all of them are constant, so is f of them.
        moves = np.any([np.diff(g.at(codes)) != 0 for g in given], axis=0)
        inner = _every(codes[:-1], np.where(moves, np.diff(codes), 1))
        codes = np.append(inner, codes[-1])
        found = f(*(g.at(codes) for g in given))
        return _drawn(given[0].word, codes, np.asarray(found, dtype=np.int64))

    def _together(self, *values: Value) -> list[Function]:
        """The values as functions of one and the same word."""
        given = [self._parts(v) for v in values]
        words = [c.word for _, curves in given for c in curves]
        if len({w.base or w for w in words}) > 1:
            said = ", ".join(sorted({f"({' '.join(sorted(_samples(w)))})" for w in words}))
            raise UnsupportedError(f"a function of words that depend on different samples: {said}")
        common = _common(words) if words else Word(next(_numbers), "", 0, 0)
        return [Function(common, *one) for one in given]

    def negative(self, v: Value) -> Value:
        """1 where v < 0, else 0: no more than the floor over a power of two that is greater than
        the magnitude of v."""
        low, high = ends(v)
        if low >= 0 or high < 0:
            return int(high < 0)
        return -self.floor(v, max(-low - 1, high).bit_length())

    def choose(self, c: Value, x: Value, y: Value) -> Value:
        """x where the bit c is 1, y where it is 0."""
        if isinstance(c, int):
            return x if c else y
        with suppress(UnsupportedError):
            return _picked(*self._together(c, x, y))
        # y + c * (x - y) hangs on one word wherever x - y does.
        return y + _picked(*self._together(c, x - y, 0))

    def clip(self, v: Value, low: int, high: int) -> Value:
        a, b = ends(v)
        if low <= a and b <= high:
            return v
        v = self.choose(self.negative(v - low), low, v)
        return self.choose(self.negative(high - v), high, v)

    def modulo(self, v: Value, bits: int, signed: bool) -> Value:
        """The number from 0, or from -2^(bits - 1) on, that is v modulo 2^bits."""
        low = -(1 << bits - 1) if signed else 0
        if isinstance(v, int):
            return (v - low) % (1 << bits) + low
        a, b = v.ends
        if a - low >> bits == b - low >> bits:
            return v - (a - low >> bits << bits)
        return v - self.floor(v - low, bits) * (1 << bits)


def _picked(c: Function, x: Function, y: Function) -> Value:
    """The choice. Between two of these codes the bit is constant and the branch is straight: where
    the bit changes, every code is taken, because at codes that no frame reaches it may be any
    number."""
    counts = np.where(np.diff(c.at(c.codes)) != 0, np.diff(c.codes), 1)
    codes = _in_order([_every(c.codes[:-1], counts), x.codes, y.codes])
    return _drawn(c.word, codes, np.where(c.at(codes) == 1, x.at(codes), y.at(codes)))


def _samples(word: Word) -> set[str]:
    """The names of the samples that a word depends on."""
    return set().union(*map(_samples, word.base.total.terms)) if word.base else {word.name}
